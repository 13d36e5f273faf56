// Moves: waypoint paths; jog and target of the hand; what Franka Desk sets.
import "./path.js";
import { h, holdButton, number, show, typed } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { refusals } from "../lib/refusals.js";
import { act, desk } from "../lib/station.js";
import { store, switchTo } from "../lib/store.js";

const AXES = ["x", "y", "z", "about x", "about y", "about z"];

class Move extends Panel {
  build() {
    this.append(
      h("st-path"),
      this.buildHand(),
      this.buildArm(),
    );
  }

  buildHand() {
    this.handState = h("p", { class: "hint" });
    this.startJog = h("button", { class: "s", type: "button" }, "Start hand jog");
    this.startJog.addEventListener("click", () => this.startKind("CartesianJogController"));
    this.startTarget = h("button", { class: "s", type: "button" }, "Start hand targets");
    this.startTarget.addEventListener("click", () => this.startKind("CartesianStreamingController"));
    this.handButtons = AXES.flatMap((axis, i) =>
      [-1, 1].map((sign) =>
        holdButton(`${sign < 0 ? "−" : "+"} ${axis}`, `Move the hand ${sign < 0 ? "against" : "along"} ${axis} while held`, () => desk.say({ do: "hand", axis: i, sign }), () => desk.say({ do: "release" })),
      ),
    );
    this.targets = ["x", "y", "z"].map((axis) => {
      const input = h("input", { class: "value", inputMode: "decimal" });
      input.setAttribute("aria-label", `Hand ${axis} [m]`);
      return input;
    });
    this.reach = h("button", { class: "s", type: "button", title: "Move the hand there; it keeps its orientation" }, "Go there");
    const go = () => {
      const position = this.targets.map((input) => typed(input.value));
      if (position.includes(null)) refusals.add({ code: "not_a_number", detail: "Type x, y and z in metres." });
      else desk.say({ do: "reach", position });
    };
    this.reach.addEventListener("click", go);
    for (const input of this.targets) input.addEventListener("keydown", (event) => event.key === "Enter" && go());
    const here = h("button", { class: "s", type: "button", title: "Fill in where the hand is" }, "Here");
    here.addEventListener("click", () => {
      const pose = Object.values(store.arms)[0]?.O_T_EE;
      if (pose) this.targets.forEach((input, i) => (input.value = number(pose[12 + i], 4)));
    });
    desk.addEventListener("change", () => this.isShown && this.showHand());
    const fields = this.targets.map((input, i) => h("label", {}, `${AXES[i]} `, input));
    return h(
      "details",
      { class: "hand" },
      h("summary", {}, "Hand: jog and target"),
      this.handState,
      h("div", { class: "line" }, this.startJog, this.startTarget),
      h("div", { class: "jog" }, ...this.handButtons),
      h("div", { class: "line" }, ...fields, " m", here, this.reach),
    );
  }

  startKind(kind) {
    const controller = store.docks.controllers.find((c) => c.type.endsWith(kind));
    if (controller) switchTo(controller.name);
    else refusals.add({ code: "no_controller", detail: `No ${kind} is loaded.`, remedy: "Load one in the dock Controllers." });
  }

  showHand() {
    const { jog, target } = desk.state;
    if (!jog) return;
    for (const button of this.handButtons) button.disabled = Boolean(jog.reason) || !jog.controller;
    this.reach.disabled = Boolean(target.reason) || !target.controller;
    this.startJog.hidden = Boolean(jog.controller) || !store.isOperator;
    this.startTarget.hidden = Boolean(target.controller) || !store.isOperator;
    const text = jog.controller && !jog.reason ? `Hold a button: ${jog.controller} moves the hand in the axes of the base.` : target.controller && !target.reason ? `${target.controller} moves the hand to a place that you type here, or to where you drag the arrows at the hand in the 3D view.` : "Start one of the two: a jog while a button is held, or targets that the hand goes to. What moves single joints stops then.";
    show(this.handState, text);
  }

  buildArm() {
    this.arm = h("select", {});
    this.arm.setAttribute("aria-label", "Arm");
    const group = (title, fields, run) => {
      const inputs = fields.map(([label, value, unit]) => {
        const input = h("input", { class: "value wide", value });
        input.setAttribute("aria-label", `${title}: ${label}`);
        return { input, row: h("label", {}, `${label} `, input, ` ${unit}`) };
      });
      const set = h("button", { class: "s", type: "button" }, "Set");
      set.setAttribute("aria-label", `Set ${title}`);
      set.addEventListener("click", () => {
        const values = inputs.map(({ input }) => input.value.split(/[,\s]+/).filter(Boolean).map(Number));
        if (values.some((list) => !list.length || list.some(Number.isNaN))) refusals.add({ code: "not_a_number", detail: `${title}: type numbers, separated by commas.` });
        else run(values);
      });
      return h("div", { class: "group" }, h("b", {}, title), ...inputs.map(({ row }) => row), set);
    };
    const put = async (route, body) => {
      if (await act("PUT", `/robots/${this.arm.value}/${route}`, body)) show(this.armState, `Set: ${route.replaceAll("_", " ")}.`);
    };
    this.armState = h("p", { class: "hint" }, "Refused while the arm moves. Vectors are typed with commas; one number fills all.");
    const all = (list, n) => (list.length === 1 ? Array(n).fill(list[0]) : list);
    const guide = h("button", { class: "s", type: "button", title: "Press the guiding buttons, so that the arm can be pushed by hand; simulation only" }, "Guiding on");
    guide.addEventListener("click", async () => {
      const pressed = guide.textContent === "Guiding on";
      if (await act("POST", `/robots/${this.arm.value}/guiding`, { pressed })) show(guide, pressed ? "Guiding off" : "Guiding on");
    });
    return h(
      "details",
      { class: "arm" },
      h("summary", {}, "Arm: collision thresholds, load, end effector"),
      this.armState,
      h("div", { class: "line" }, this.arm, guide),
      group("Collision thresholds", [["contact torque", "20, 20, 18, 18, 16, 14, 12", "Nm"], ["collision torque", "40, 40, 36, 36, 32, 28, 24", "Nm"], ["contact force", "20, 20, 20, 25, 25, 25", "N, Nm"], ["collision force", "40, 40, 40, 50, 50, 50", "N, Nm"]], ([a, b, c, d]) =>
        put("force_torque_collision_behavior", { lower_torque_thresholds_nominal: all(a, 7), upper_torque_thresholds_nominal: all(b, 7), lower_force_thresholds_nominal: all(c, 6), upper_force_thresholds_nominal: all(d, 6) })),
      group("Load", [["mass", "0.2", "kg"], ["centre in the flange", "0, 0, 0.1", "m"], ["inertia xx, yy, zz", "0.001, 0.001, 0.001", "kg m²"]], ([mass, centre, [x, y, z]]) =>
        put("load", { mass: mass[0], F_x_center_load: centre, load_inertia: [x, 0, 0, 0, y, 0, 0, 0, z] })),
      group("End effector in the nominal frame", [["x, y, z", "0, 0, 0", "m"]], ([[x, y, z]]) => put("ee_frame", { NE_T_EE: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1] })),
    );
  }

  refresh() {
    const arms = store.docks.arms.map((arm) => arm.arm_id);
    if (arms.join() !== this.arms) {
      this.arms = arms.join();
      this.arm.replaceChildren(...arms.map((name) => h("option", {}, name)));
      this.querySelector(".arm").hidden = this.querySelector(".hand").hidden = !arms.length;
    }
    this.showHand();
  }
}

customElements.define("st-move", Move);
