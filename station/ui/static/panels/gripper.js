// Gripper: how wide it is, and open, close, grasp with a force, home.
import { act, api, button, field, h, line, number, Panel, show, store } from "../lib/panel.js";

const LOOK_MS = 400;

class Gripper extends Panel {
  build() {
    this.arms = new Map();
    this.none = h("p", { class: "hint" }, "This robot has no gripper.");
    this.append(this.none);
    // An arm without a hand has no gripper.
    this.every(LOOK_MS, () => Promise.allSettled(store.docks.arms.map(({ arm_id: arm }) => this.lookAt(arm))));
  }

  async lookAt(arm) {
    const told = await api("GET", `/robots/${arm}/gripper`);
    if (!this.arms.has(arm)) this.add(arm, told);
    const state = this.arms.get(arm);
    const last = told.command ?? told.last;
    const doing = told.command ? `${told.command.action} …` : last ? `${last.action} ${last.status}${last.message ? `: ${last.message}` : ""}` : told.activity;
    const held = told.is_grasped ? `holds an object with ${number(Math.abs(told.force), 0)} N` : "holds nothing";
    show(state, `${number(told.width * 1e3, 1)} mm of ${number(told.max_width * 1e3, 0)} mm · ${held} · ${doing}`);
  }

  add(arm, told) {
    this.none.hidden = true;
    const width = field("object", "40", "mm");
    const force = field("force", "20", "N");
    const tolerance = field("±", "10", "mm");
    const go = (action, body) => () => act("POST", `/robots/${arm}/gripper/${action}`, body?.());
    const millimetres = (one) => (one.read() ?? NaN) / 1e3;
    const actions = [
      ["Open", "Open all the way", go("move", () => ({ width: told.max_width }))],
      ["Close", "Close all the way, without pressing", go("move", () => ({ width: 0 }))],
      [
        "Grasp",
        "Close until an object stops the fingers, then press it; succeeds when its width is within the tolerance",
        go("grasp", () => ({
          width: millimetres(width),
          force: force.read(),
          epsilon: { inner: millimetres(tolerance), outer: millimetres(tolerance) },
        })),
      ],
      ["Home", "Close and open all the way, to learn the width", go("homing")],
      ["Hold still", "Stop the fingers; releases an object", go("stop"), "change"],
    ];
    const several = store.docks.arms.length > 1;
    const buttons = actions.map(([label, title, run, needs = "motion"]) => button(label, title, run, { needs, class: label === "Grasp" ? "s primary" : "s", ariaLabel: several ? `${label}, ${arm}` : label }));
    const state = h("p", { class: "state" });
    const title = several ? h("b", {}, arm) : null;
    const [open, close, grasp, home, hold] = buttons;
    this.append(h("div", {}, title, state, line(open, close, home, hold), line(grasp, width.label, tolerance.label, force.label)));
    this.arms.set(arm, state);
  }
}

customElements.define("st-gripper", Gripper);
