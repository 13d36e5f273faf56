// What Franka Desk sets of an arm: collision thresholds, load, end effector, guiding.
import { act, api, button, h, line, number, Panel, refusals, show, store, typed } from "../lib/panel.js";

const repeated = (list, n) => (list.length === 1 ? Array(n).fill(list[0]) : list);
const rounded = (list) => list.map((value) => String(Number(number(value, 6)))).join(", ");

/**
 * The settings: their fields as [label, unit, what the arm says, an example], and what is sent.
 * The arm tells no thresholds: their fields are empty until somebody types.
 */
const SETTINGS = [
  {
    title: "Collision thresholds",
    route: "force_torque_collision_behavior",
    fields: [
      ["contact torque", "Nm", null, "20, 20, 18, 18, 16, 14, 12"],
      ["collision torque", "Nm", null, "40, 40, 36, 36, 32, 28, 24"],
      ["contact force", "N, Nm", null, "20, 20, 20, 25, 25, 25"],
      ["collision force", "N, Nm", null, "40, 40, 40, 50, 50, 50"],
    ],
    body: ([a, b, c, d]) => ({ lower_torque_thresholds_nominal: repeated(a, 7), upper_torque_thresholds_nominal: repeated(b, 7), lower_force_thresholds_nominal: repeated(c, 6), upper_force_thresholds_nominal: repeated(d, 6) }),
  },
  {
    title: "Load",
    route: "load",
    fields: [
      ["mass", "kg", (arm) => [arm.m_load]],
      ["centre in the flange", "m", (arm) => arm.F_x_Cload],
      ["inertia xx, yy, zz", "kg m²", (arm) => [0, 4, 8].map((i) => arm.I_load[i])],
    ],
    body: ([[mass], centre, [x, y, z]]) => ({ mass, F_x_center_load: centre, load_inertia: [x, 0, 0, 0, y, 0, 0, 0, z] }),
  },
  {
    title: "End effector in the nominal frame",
    route: "ee_frame",
    fields: [["x, y, z", "m", (arm) => arm.NE_T_EE.slice(12, 15)]],
    // The rotation stays as the arm has it.
    body: ([[x, y, z]], arm) => ({ NE_T_EE: [...arm.NE_T_EE.slice(0, 12), x, y, z, 1] }),
  },
];

class ArmSettings extends Panel {
  build() {
    this.inputs = []; // {input, of: what the arm says, or null}
    this.state = h("p", { class: "hint" }, "Refused while the arm moves. Vectors are typed with commas; one number fills all thresholds. The arm does not tell the thresholds that hold.");
    this.guide = button("Guiding on", "Press the guiding buttons, so that the simulated arm can be pushed by hand.", () => act("POST", `/robots/${this.armName}/guiding`, { pressed: !this.isGuided }).then(() => store.refresh()), { needs: "change", off: () => this.isMoving });
    this.details = h("details", { class: "arm" }, h("summary", {}, "Arm: collision thresholds, load, end effector"), this.state, line(this.guide), ...SETTINGS.map((setting) => this.group(setting)));
    this.details.addEventListener("toggle", () => this.details.open && this.read());
    this.append(this.details);
    // Scripts and other pages set the arm, too.
    store.addEventListener("happened", ({ detail }) => detail.what.startsWith(`PUT /robots/${this.armName}/`) && this.read());
  }

  group(setting) {
    const { title, fields } = setting;
    const inputs = fields.map(([label, unit, of, example]) => {
      const input = h("input", { class: "value wide", placeholder: example ? `e.g. ${example}` : "", ariaLabel: `${title}: ${label}`, data: { was: "" } });
      this.inputs.push({ input, of });
      return { input, row: h("label", {}, `${label} `, input, ` ${unit}`) };
    });
    const set = button("Set", undefined, () => this.set(setting, inputs.map(({ input }) => input)), { ariaLabel: `Set ${title}`, needs: "change", off: () => this.isMoving || inputs.some(({ input }) => !input.value.trim()) });
    return h("div", { class: "group" }, h("b", {}, title), ...inputs.map(({ row }) => row), set);
  }

  async set({ title, route, body }, inputs) {
    const values = inputs.map((input) => input.value.split(/[,\s]+/).filter(Boolean).map(typed));
    if (values.some((list) => !list.length || list.includes(null))) return refusals.add({ code: "not_a_number", detail: `${title}: type numbers, separated by commas.` });
    const arm = await act("GET", `/robots/${this.armName}/state`);
    if (!arm || !(await act("PUT", `/robots/${this.armName}/${route}`, body(values, arm)))) return undefined;
    for (const input of inputs) input.dataset.was = input.value; // shown as the arm has it from now on
    show(this.state, `Set: ${title.toLowerCase()}.`);
    return this.read();
  }

  /** The arm whose settings these are. */
  set arm(name) {
    if (name === this.armName) return;
    this.armName = name;
    for (const { input } of this.inputs) input.value = input.dataset.was = "";
    this.read();
    if (this.isShown) this.refresh();
  }

  /** Show what the arm has now, but where somebody types. */
  async read() {
    const name = this.armName;
    if (!name || !this.details.open) return;
    const arm = await api("GET", `/robots/${name}/state`).catch(() => null); // a lost station is in the strip
    if (!arm || name !== this.armName) return;
    for (const { input, of } of this.inputs) {
      if (!of) continue;
      const is = rounded(of(arm));
      if (input.value === input.dataset.was && input !== document.activeElement) input.value = is;
      input.dataset.was = is;
    }
  }

  /** What the station says of the arm. */
  get told() {
    return store.docks?.arms.find((arm) => arm.arm_id === this.armName);
  }

  get isMoving() {
    return this.told?.robot_mode === "move";
  }

  get isGuided() {
    return this.told?.robot_mode === "guiding";
  }

  refresh() {
    this.guide.hidden = !store.docks?.simulation;
    this.guide.ariaPressed = this.isGuided;
    show(this.guide, this.isGuided ? "Guiding off" : "Guiding on");
  }
}

customElements.define("st-arm-settings", ArmSettings);
