// Moves: waypoint paths; jog and target of a hand; what Franka Desk sets of an arm.
import "./arm_settings.js";
import "./gamepad.js";
import "./hand.js";
import "./path.js";
import { h, kept, offer, Panel, store } from "../lib/panel.js";

customElements.define("st-move", class Move extends Panel {
  build() {
    this.choice = h("select", { title: "Arm whose hand is moved and whose settings are shown.", ariaLabel: "Arm", onchange: () => this.choose(this.choice.value) });
    this.line = h("div", { class: "line", hidden: true }, h("label", {}, "arm ", this.choice));
    this.parts = [h("st-hand"), h("st-gamepad"), h("st-arm-settings")];
    this.append(h("st-path"), this.line, ...this.parts);
  }

  choose(arm) {
    kept.set("arm", arm);
    for (const part of this.parts) part.arm = arm;
  }

  refresh() {
    const arms = store.docks.arms.map((arm) => arm.arm_id);
    if (arms.join() === this.arms) return;
    this.arms = arms.join();
    offer(this.choice, arms, "no arm");
    this.line.hidden = arms.length < 2;
    for (const part of this.parts) part.hidden = !arms.length;
    if (!arms.length) return;
    const before = kept.get("arm", "");
    this.choice.value = arms.includes(before) ? before : arms[0];
    this.choose(this.choice.value);
  }
});
