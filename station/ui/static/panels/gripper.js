// Gripper: how wide it is, and open, close, grasp with a force, home.
import { act, api, field, html, nothing, number, Panel, press, store } from "../lib/panel.js";

const LOOK_MS = 400;

customElements.define("st-gripper", class Gripper extends Panel {
  build() {
    this.arms = new Map(); // what each gripper tells, and its fields, by the arm
    this.refresh();
    // An arm without a hand has no gripper.
    this.every(LOOK_MS, () => Promise.allSettled(store.docks.arms.map(({ arm_id: arm }) => this.lookAt(arm))));
  }

  async lookAt(arm) {
    const answer = await api("GET", `/robots/${arm}/gripper`);
    const fields = this.arms.get(arm)?.fields ?? { width: field("object", "40", "mm"), tolerance: field("±", "10", "mm"), force: field("force", "20", "N") };
    this.arms.set(arm, { answer, fields });
    this.refresh();
  }

  view() {
    return this.arms.size ? [...this.arms].map(([arm, one]) => this.gripper(arm, one)) : html`<p class="hint">This robot has no gripper.</p>`;
  }

  gripper(arm, { answer, fields: { width, tolerance, force } }) {
    const several = store.docks.arms.length > 1;
    const last = answer.command ?? answer.last;
    const doing = answer.command ? `${answer.command.action} …` : last ? `${last.action} ${last.status}${last.message ? `: ${last.message}` : ""}` : answer.activity;
    const held = answer.is_grasped ? `holds an object with ${number(Math.abs(answer.force), 0)} N` : "holds nothing";
    const millimetres = (one) => (one.read() ?? NaN) / 1e3;
    const go = (label, title, action, body, rule) => press(label, title, () => act("POST", `/robots/${arm}/gripper/${action}`, body?.()), { needs: "motion", name: several ? `${label}, ${arm}` : label, ...rule });
    const grasp = () => ({ width: millimetres(width), force: force.read(), epsilon: { inner: millimetres(tolerance), outer: millimetres(tolerance) } });
    return html`<div>${several ? html`<b>${arm}</b>` : nothing}<p class="state">${number(answer.width * 1e3, 1)} mm of ${number(answer.max_width * 1e3, 0)} mm · ${held} · ${doing}</p>
      <div class="line">${go("Open", "Open all the way", "move", () => ({ width: answer.max_width }))}${go("Close", "Close all the way, without pressing", "move", () => ({ width: 0 }))}
        ${go("Home", "Close and open all the way, to learn the width", "homing")}${go("Hold still", "Stop the fingers; releases an object", "stop", undefined, { needs: "change" })}</div>
      <div class="line">${go("Grasp", "Close until an object stops the fingers, then press it; succeeds when its width is within the tolerance", "grasp", grasp, { look: "s primary" })}${width.label}${tolerance.label}${force.label}</div></div>`;
  }
});
