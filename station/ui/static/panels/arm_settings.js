// What Franka Desk sets of an arm: collision thresholds, load, end effector, guiding.
import { act, html, live, number, Panel, peek, press, refusals, store, typed } from "../lib/panel.js";

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

customElements.define("st-arm-settings", class ArmSettings extends Panel {
  build() {
    this.typed = new Map(); // what somebody has typed, by the label of the field
    this.says = "Refused while the arm moves. Vectors are typed with commas; one number fills all thresholds. The arm does not tell the thresholds that hold.";
    this.refresh();
    // Scripts and other pages set the arm, too.
    store.addEventListener("happened", ({ detail }) => detail.what.startsWith(`PUT /robots/${this.armName}/`) && this.read());
  }

  view() {
    const isGuided = store.isArmIn("guiding", this.armName);
    const guide = () => act("POST", `/robots/${this.armName}/guiding`, { pressed: !isGuided }).then(() => store.refresh());
    return html`<details class="arm" @toggle=${() => this.read()}><summary>Arm: collision thresholds, load, end effector</summary><p class="hint">${this.says}</p>
      <div class="line" ?hidden=${!store.docks?.simulation}>${press(isGuided ? "Guiding off" : "Guiding on", "Press the guiding buttons, so that the simulated arm can be pushed by hand.", guide, { needs: "change", off: () => store.isArmIn("move", this.armName), pressed: isGuided })}</div>
      ${SETTINGS.map((setting) => this.group(setting))}</details>`;
  }

  group(setting) {
    const { title, fields } = setting;
    const keyOf = (label) => `${title}: ${label}`;
    const textOf = ([label, , of]) => this.typed.get(keyOf(label)) ?? (of && this.known ? rounded(of(this.known)) : "");
    const field = (one) => {
      const [label, unit, , example] = one;
      return html`<label>${label} <input class="value wide" placeholder=${example ? `e.g. ${example}` : ""} aria-label=${keyOf(label)} .value=${live(textOf(one))} @input=${({ target }) => this.typed.set(keyOf(label), target.value)} /> ${unit}</label>`;
    };
    const off = () => store.isArmIn("move", this.armName) || fields.some((one) => !textOf(one).trim());
    return html`<div class="group"><b>${title}</b>${fields.map(field)}${press("Set", "", () => this.set(setting, fields.map(textOf)), { name: `Set ${title}`, needs: "change", off })}</div>`;
  }

  async set({ title, route, body, fields }, texts) {
    const values = texts.map((text) => text.split(/[,\s]+/).filter(Boolean).map(typed));
    if (values.some((list) => list.includes(null))) return refusals.add({ code: "not_a_number", detail: `${title}: type numbers, separated by commas.` });
    const arm = await act("GET", `/robots/${this.armName}/state`);
    if (!arm || !(await act("PUT", `/robots/${this.armName}/${route}`, body(values, arm)))) return;
    for (const [label, , of] of fields) if (of) this.typed.delete(`${title}: ${label}`); // shown as the arm has it from now on
    this.says = `Set: ${title.toLowerCase()}.`;
    this.read();
  }

  /** The arm whose settings these are. */
  set arm(name) {
    if (name === this.armName) return;
    this.armName = name;
    this.known = null;
    this.typed.clear();
    this.read();
    if (this.isShown) this.refresh();
  }

  /** Show what the arm has now, but where somebody has typed. */
  async read() {
    const name = this.armName;
    if (!name || !this.firstElementChild.open) return;
    const arm = await peek(`/robots/${name}/state`);
    if (!arm || name !== this.armName) return;
    this.known = arm;
    this.refresh();
  }

});
