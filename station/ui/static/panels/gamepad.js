// Gamepad: moves the hand while its dead-man button is held; the map shows what does what.
import { directionsOf } from "../lib/gamepad_map.js";
import { html, kept, Panel, ranged, render, store, teleoperation } from "../lib/panel.js";

const LOOK_MS = 40; // the dashboard takes 25 set-points a second
const DEAD_MAN = { button: 5, words: "right shoulder button" };
const STOP = { button: 1, words: "right one of the four buttons (B, ○)" };
const MAP = [
  ["along x", "left stick, forwards and back"],
  ["along y", "left stick, to the left and right"],
  ["along z", "right stick, forwards and back"],
  ["about x", "cross, to the right and left"],
  ["about y", "cross, up and down"],
  ["about z", "right stick, to the left and right"],
];
const REST = MAP.map(() => 0);

customElements.define("st-gamepad", class GamepadPanel extends Panel {
  build() {
    this.scale = ranged("scale", (value) => `${value} %`, (value) => kept.set("gamepad-scale", value), { min: 5, max: 100, step: 5, value: kept.get("gamepad-scale", 50), title: "Part of the top speeds of the hand at a full deflection.", ariaLabel: "Scale of the gamepad in percent" });
    this.asked = []; // the directions that were sent last
    this.draw("", REST, false);
    setInterval(() => this.look(), LOOK_MS);
  }

  draw(state, directions, isStop) {
    const row = (axis, control, now) => html`<tr><th scope="row">${axis}</th><td>${control}</td><td>${now}</td></tr>`;
    render(html`<details><summary>Gamepad</summary><p class="hint" role="status">${state}</p>${this.scale.label}
      <table class="objects"><thead><tr><th>hand</th><th>control</th><th>now</th></tr></thead>
        <tbody>${MAP.map(([axis, control], i) => row(axis, control, directions[i].toFixed(2)))}${row("STOP", STOP.words, isStop ? "pressed" : "–")}</tbody></table></details>`, this);
  }

  /** The arm whose hand moves. */
  set arm(name) {
    this.letGo();
    this.armName = name;
  }

  /** Why nothing moves, or an empty text. A pad acts only on a page that somebody looks at, and whose map is in sight. */
  reasonOf(pad) {
    const { hands } = teleoperation.state;
    const { jog } = hands?.[this.armName] ?? hands?.[""] ?? {};
    if (!store.isOperator) return "This session only watches.";
    if (!pad) return "No gamepad is heard: connect one, and press one of its buttons.";
    if (!jog?.controller || jog.reason) return "Start the hand jog above.";
    if (!document.hasFocus()) return "This page does not have the focus.";
    return pad.buttons[DEAD_MAN.button]?.pressed ? "" : `Hold the ${DEAD_MAN.words}: the hand moves only meanwhile.`;
  }

  look() {
    const isSeen = this.isShown && this.firstElementChild.open;
    const pad = isSeen ? [...navigator.getGamepads()].find((one) => one?.mapping === "standard") : null;
    const isStop = Boolean(pad?.buttons[STOP.button]?.pressed);
    if (isStop && !this.isStop) document.getElementById("stop").click();
    this.isStop = isStop;
    if (!isSeen) return this.letGo();
    const directions = pad ? directionsOf(pad) : REST;
    const reason = isStop ? "STOP." : this.reasonOf(pad);
    this.draw(reason || "The hand moves.", directions, isStop);
    if (reason || !directions.some(Boolean)) return this.letGo();
    this.isHeld = true;
    const { along, about } = kept.get("hand-speed", { along: 0.05, about: 0.3 });
    const part = this.scale.input.value / 100;
    teleoperation.say({ do: "hand_speed", along: along * part, about: about * part });
    // A direction that was left is said once more, or it would count as held for a moment.
    directions.forEach((size, axis) => (size || this.asked[axis]) && teleoperation.say({ do: "hand", arm: this.armName, axis, sign: size }));
    this.asked = directions;
  }

  letGo() {
    if (this.isHeld) teleoperation.say({ do: "release" });
    this.isHeld = false;
    this.asked = [];
  }
});
