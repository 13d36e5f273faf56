// The hand of one arm: held directions, a typed place, and how fast it may move.
import { h, holdButton, kept, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { refusals } from "../lib/refusals.js";
import { act, api, teleoperation } from "../lib/station.js";
import { store, switchTo } from "../lib/store.js";
import { number, typed } from "../lib/text.js";

const AXES = ["x", "y", "z", "about x", "about y", "about z"];
const JOG = "CartesianJogController";
const TARGETS = "CartesianStreamingController";
/** In whose axes a jog moves the hand, by the value of its gain `frame`. */
const FRAMES = ["the base", "the end effector"];
/** Speeds at first, and the most that is offered until a controller says its own [m/s], [rad/s]. */
const SPEEDS = { along: 0.05, about: 0.3 };
const MOST = { along: 0.3, about: 1 };

class Hand extends Panel {
  build() {
    this.state = h("p", { class: "hint" });
    const starter = (label, kind) => h("button", { class: "s", type: "button", onclick: () => this.start(kind) }, label);
    this.startJog = starter("Start hand jog", JOG);
    this.startTarget = starter("Start hand targets", TARGETS);
    this.handButtons = AXES.flatMap((axis, i) =>
      [-1, 1].map((sign) =>
        holdButton(`${sign < 0 ? "−" : "+"} ${axis}`, `Move the hand ${sign < 0 ? "against" : "along"} ${axis} while held`, () => this.hold(i, sign), () => teleoperation.say({ do: "release" })),
      ),
    );
    this.targets = ["x", "y", "z"].map((axis) => {
      const input = h("input", { class: "value", inputMode: "decimal" });
      input.setAttribute("aria-label", `Hand ${axis} [m]`);
      input.addEventListener("keydown", (event) => event.key === "Enter" && this.go());
      return input;
    });
    this.reach = h("button", { class: "s", type: "button", title: "Move the hand there; it keeps its orientation.", onclick: () => this.go() }, "Go there");
    this.axes = h("select", { title: "Frame along whose axes the buttons move the hand." }, ...FRAMES.map((frame, i) => h("option", { value: String(i) }, frame)));
    this.axes.setAttribute("aria-label", "Axes of the jog");
    this.axes.addEventListener("change", () => this.setFrame());
    const here = h("button", { class: "s", type: "button", title: "Fill in where the hand is.", onclick: () => this.fillIn() }, "Here");
    teleoperation.addEventListener("change", () => this.isShown && this.refresh());
    store.addEventListener("gains", () => (this.framed = "")); // the axes are a gain of the jog
    const fields = this.targets.map((input, i) => h("label", {}, `${AXES[i]} `, input));
    this.append(
      h(
        "details",
        { class: "hand" },
        h("summary", {}, "Hand: jog and target"),
        this.state,
        h("div", { class: "line" }, this.startJog, this.startTarget),
        this.buildSpeeds(),
        h("div", { class: "line" }, h("label", {}, "axes of ", this.axes)),
        h("div", { class: "jog" }, ...this.handButtons),
        h("div", { class: "line" }, ...fields, " m", here, this.reach),
      ),
    );
  }

  buildSpeeds() {
    const slider = (key, label, unit, step) => {
      const input = h("input", { type: "range", min: step, max: MOST[key], step, value: kept.get("hand-speed", SPEEDS)[key] });
      input.setAttribute("aria-label", `${label} [${unit}]`);
      const text = h("output", {});
      const tell = () => show(text, `${number(Number(input.value), 2)} ${unit}`);
      input.addEventListener("input", () => {
        tell();
        kept.set("hand-speed", this.chosenSpeeds);
      });
      tell();
      return { input, tell, row: h("label", { class: "speed" }, `${label} `, input, text) };
    };
    this.speeds = { along: slider("along", "Top speed of the hand", "m/s", 0.01), about: slider("about", "Top turning speed of the hand", "rad/s", 0.05) };
    return h("div", { class: "line" }, this.speeds.along.row, this.speeds.about.row);
  }

  /** The arm whose hand this is. */
  set arm(name) {
    if (name === this.armName) return;
    if (this.armName && store.isOperator) teleoperation.say({ do: "release" });
    this.armName = name;
    this.framed = "";
    for (const input of this.targets) input.value = ""; // a place in the base of another arm
    if (this.isShown) this.refresh();
  }

  /** The state of this hand; a station with one arm does not name the arm. */
  get told() {
    const { hands } = teleoperation.state;
    return hands?.[this.armName] ?? hands?.[""];
  }

  hold(axis, sign) {
    // With every message, since a socket that was opened anew does not know it.
    teleoperation.say({ do: "hand_speed", ...this.chosenSpeeds });
    teleoperation.say({ do: "hand", arm: this.armName, axis, sign });
  }

  /** The top speeds that were chosen [m/s], [rad/s]. */
  get chosenSpeeds() {
    return Object.fromEntries(Object.entries(this.speeds).map(([key, { input }]) => [key, Number(input.value)]));
  }

  go() {
    const position = this.targets.map((input) => typed(input.value));
    if (position.includes(null)) refusals.add({ code: "not_a_number", detail: "Type x, y and z in metres." });
    else teleoperation.say({ do: "reach", arm: this.armName, position });
  }

  fillIn() {
    const pose = store.arms[this.armName]?.O_T_EE;
    if (pose) this.targets.forEach((input, i) => (input.value = number(pose[12 + i], 4)));
  }

  start(kind) {
    const controller = store.docks.controllers.find((c) => c.type.endsWith(kind) && c.arms.includes(this.armName));
    if (controller) switchTo(controller.name);
    else refusals.add({ code: "no_controller", detail: `No ${kind} of ${this.armName} is loaded.`, remedy: "Load one in the dock Controllers, with the arm_id and the joints of this arm." });
  }

  /** Ask in which axes a jog controller moves the hand. */
  async askFrame(name) {
    this.framed = name;
    const gains = await api("GET", `/controllers/${name}/gains`).catch(() => null);
    if (name !== this.framed) return;
    if (gains) {
      this.frame = gains.values.frame;
      this.axes.value = String(this.frame);
    } else this.framed = ""; // asked again
  }

  /** Let a running jog controller move the hand in other axes. */
  async setFrame() {
    const { controller } = this.told.jog;
    await act("PATCH", `/controllers/${controller}/gains`, { values: { frame: Number(this.axes.value) } });
    this.framed = ""; // asked again, also when it was refused
  }

  refresh() {
    if (!this.told) return;
    const { jog, target, message, fastest } = this.told;
    const isOf = ({ controller, reason }) => Boolean(controller) && !reason;
    for (const button of this.handButtons) button.disabled = !isOf(jog);
    this.reach.disabled = !isOf(target);
    this.axes.disabled = !isOf(jog) || !store.isOperator;
    this.startJog.hidden = Boolean(jog.controller) || !store.isOperator;
    this.startTarget.hidden = Boolean(target.controller) || !store.isOperator;
    if (isOf(jog) && jog.controller !== this.framed) this.askFrame(jog.controller);
    Object.values(this.speeds).forEach(({ input, tell }, i) => {
      const most = String(fastest ? fastest[i] : Object.values(MOST)[i]);
      if (input.max === most) return;
      input.max = most;
      tell();
    });
    const text = message
      ? `⚠ ${message}`
      : isOf(jog)
        ? `Hold a button: ${jog.controller} moves the hand in the axes of ${FRAMES[this.frame] ?? FRAMES[0]}.`
        : isOf(target)
          ? `${target.controller} moves the hand to a place that you type here, or to where you drag the arrows at the hand in the 3D view.`
          : "Start one of the two: a jog while a button is held, or targets that the hand goes to. What moves single joints stops then.";
    show(this.state, text);
  }
}

customElements.define("st-hand", Hand);
