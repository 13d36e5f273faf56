// The hand of one arm: held directions, steps, a typed pose, and how fast it may move.
import { Forecast } from "../lib/forecast.js";
import { act, angleField, button, choice, DEGREES, h, holdButton, kept, line, number, offer, Panel, peek, ranged, refusals, show, store, switchTo, teleoperation, typed, units, valueField } from "../lib/panel.js";

const AXES = ["x", "y", "z", "about x", "about y", "about z"];
const JOG = "CartesianJogController";
const TARGETS = "CartesianStreamingController";
/** In whose axes a jog moves the hand, by the value of its gain `frame`. */
const FRAMES = ["the base", "the end effector"];
/** Speeds at first, and the most that is offered until a controller says its own [m/s], [rad/s]. */
const SPEEDS = { along: 0.05, about: 0.3 };
const MOST = { along: 0.3, about: 1 };
/** Steps of the buttons while the hand takes targets [m], [rad]. */
const STEPS = [
  { along: 1e-4, about: 0.1 / DEGREES },
  { along: 1e-3, about: 1 / DEGREES },
  { along: 1e-2, about: 5 / DEGREES },
];
const ANGLES = ["roll", "pitch", "yaw"];
const FIRST_TURN = 3;

customElements.define("st-hand", class Hand extends Panel {
  build() {
    this.state = h("p", { class: "hint" });
    this.startJog = button("Start hand jog", undefined, () => this.start(JOG), { needs: "motion" });
    this.startTarget = button("Start hand targets", undefined, () => this.start(TARGETS), { needs: "motion" });
    const hold = (axis, i, sign) => holdButton(`${sign < 0 ? "−" : "+"} ${axis}`, "", () => this.press(i, sign), () => this.letGo());
    this.handButtons = AXES.flatMap((axis, i) => [hold(axis, i, -1), hold(axis, i, 1)]);
    this.targets = AXES.slice(0, FIRST_TURN).map((axis) => valueField(`Hand ${axis} [m]`, () => this.go()));
    this.angles = ANGLES.map((angle) => angleField(angle, null, "", valueField(`Hand ${angle}`, () => this.go())));
    this.step = choice("Step of the hand", [], () => kept.set("hand-step", Number(this.step.value)), { title: "How far one press of a button moves the hand; while the hand takes targets." });
    this.listSteps(kept.get("hand-step", 1));
    units.addEventListener("change", () => {
      this.listSteps(this.step.value);
      this.speeds.about.tell();
    });
    const isEmpty = () => this.targets.some((input) => !input.value.trim());
    const reach = button("Go there", "Move the hand there; without angles it keeps its orientation.", () => this.go(), { needs: "motion", off: () => !this.isStepping || isEmpty() });
    const speed = (key, ariaLabel, textOf, step) => ranged(ariaLabel, textOf, () => kept.set("hand-speed", this.chosenSpeeds), { min: step, max: MOST[key], step, value: kept.get("hand-speed", SPEEDS)[key], ariaLabel });
    const along = speed("along", "Top speed of the hand", (value) => `${number(value, 2)} m/s`, 0.01);
    const about = speed("about", "Top turning speed of the hand", (value) => `${number(value * units.scale, units.angle === "deg" ? 0 : 2)}${units.sign}/s`, 0.05);
    this.speeds = { along, about };
    this.axes = choice("Axes of the jog", FRAMES.map((frame, i) => [i, frame]), () => this.setFrame(), { title: "Frame along whose axes the buttons move the hand." });
    this.forecast = new Forecast();
    const trials = this.forecast.trials(() => this.tryOut(false), () => this.tryOut(true), isEmpty);
    const here = button("Here", "Fill in where the hand is.", () => this.fillIn());
    teleoperation.addEventListener("change", () => this.isShown && this.refresh());
    store.addEventListener("gains", () => (this.framed = "")); // the axes are a gain of the jog
    const details = h("details", { class: "hand" },
      h("summary", {}, "Hand: jog and target"),
      this.state,
      line(this.startJog, this.startTarget),
      line(along.label, about.label),
      line(h("label", {}, "axes of ", this.axes), h("label", {}, "step ", this.step)),
      h("div", { class: "jog" }, ...this.handButtons),
      line(...this.targets.map((input, i) => h("label", {}, `${AXES[i]} `, input)), " m"),
      line(...this.angles.map(({ label }) => label), here, reach, ...trials),
      this.forecast.element,
    );
    this.append(details);
  }

  /** The arm whose hand this is. */
  set arm(name) {
    if (name === this.armName) return;
    if (this.armName && store.isOperator) teleoperation.say({ do: "release" });
    this.armName = name;
    this.framed = "";
    for (const input of this.targets) input.value = ""; // a pose in the base of another arm
    for (const angle of this.angles) angle.put(null);
    if (this.isShown) this.refresh();
  }

  /** The state of this hand; a station with one arm does not name the arm. */
  get live() {
    const { hands } = teleoperation.state;
    return hands?.[this.armName] ?? hands?.[""];
  }

  /** A button is pressed, or still held: a jog moves while it is, a step is made once. */
  press(axis, sign) {
    if (this.isStepping) {
      const { along, about } = STEPS[Number(this.step.value)];
      const by = AXES.map((_, i) => (i === axis ? sign * (i < FIRST_TURN ? along : about) : 0));
      if (!this.isPressed) this.reach({ position: by.slice(0, FIRST_TURN), rpy: by.slice(FIRST_TURN) }, this.axes.value === "1" ? "tool" : "base");
      this.isPressed = true;
      return;
    }
    // With every message, since a socket that was opened anew does not know it.
    teleoperation.say({ do: "hand_speed", ...this.chosenSpeeds });
    teleoperation.say({ do: "hand", arm: this.armName, axis, sign });
  }

  letGo() {
    if (!this.isPressed) teleoperation.say({ do: "release" });
    this.isPressed = false;
  }

  reach(place, step_in = "") {
    teleoperation.say({ do: "reach", arm: this.armName, place, step_in });
  }

  listSteps(chosen) {
    const angle = (value) => (units.angle === "deg" ? `${Number((value * DEGREES).toFixed(1))}°` : `${number(value, 4)} rad`);
    offer(this.step, STEPS.map(({ along, about }, i) => [String(i), `${along * 1e3} mm, ${angle(about)}`]));
    this.step.value = String(chosen);
  }

  /** The top speeds that were chosen [m/s], [rad/s]. */
  get chosenSpeeds() {
    return Object.fromEntries(Object.entries(this.speeds).map(([key, { input }]) => [key, Number(input.value)]));
  }

  /** Return the typed pose {position, rpy}, without `rpy` if no angle was typed; nothing when it is none. */
  typedPose() {
    const position = this.targets.map((input) => typed(input.value));
    const angles = this.angles.map((angle) => angle.read());
    const isOfPlace = this.angles.every(({ input }) => !input.value.trim());
    if (position.includes(null) || (angles.includes(null) && !isOfPlace)) {
      refusals.add({ code: "not_a_number", detail: "Type x, y and z in metres, and all three angles or none." });
      return null;
    }
    return isOfPlace ? { position } : { position, rpy: angles };
  }

  /** Try to reach the typed pose; without angles the hand keeps its orientation. */
  tryOut(isAround) {
    const pose = this.typedPose();
    if (!pose) return;
    const joints = Object.fromEntries(store.docks.joints.filter((joint) => joint.startsWith(`${this.armName}_joint`)).map((joint) => [joint, 0]));
    if (isAround) this.forecast.goAround(joints, pose);
    else this.forecast.rehearseHand(joints, pose, kept.get("speed", 29) / DEGREES);
  }

  go() {
    const pose = this.typedPose();
    if (!pose) return;
    for (const input of [...this.targets, ...this.angles.map((angle) => angle.input)]) input.edited = false;
    this.reach(pose);
    if (this.contains(document.activeElement)) document.activeElement.select?.(); // to be typed over
  }

  /** Fill in what the hand is told, or else where it is. */
  fillIn() {
    const place = this.live?.place;
    if (!place) return;
    this.targets.forEach((input, i) => (input.value = number(place[i], 4)));
    this.angles.forEach((angle, i) => angle.put(place[i + FIRST_TURN]));
  }

  start(kind) {
    const controller = store.docks.controllers.find((c) => c.type.endsWith(kind) && c.arms.includes(this.armName));
    if (controller) switchTo(controller.name);
    else refusals.add({ code: "no_controller", detail: `No ${kind} of ${this.armName} is loaded.`, remedy: "Load one in the dock Controllers, with the arm_id and the joints of this arm." });
  }

  /** Ask in which axes a jog controller moves the hand. */
  async askFrame(name) {
    this.framed = name;
    const gains = await peek(`/controllers/${name}/gains`);
    if (name !== this.framed) return;
    if (!gains) return void (this.framed = ""); // asked again
    this.frame = gains.values.frame;
    this.axes.value = String(this.frame);
  }

  /** Let a running jog controller move the hand in other axes. */
  async setFrame() {
    if (this.isStepping) return; // steps are made here
    const { controller } = this.live.jog;
    await act("PATCH", `/controllers/${controller}/gains`, { values: { frame: Number(this.axes.value) } });
    this.framed = ""; // asked again, also when it was refused
  }

  refresh() {
    if (!this.live) return;
    const { jog, target, message, fastest } = this.live;
    const isOf = ({ controller, reason }) => Boolean(controller) && !reason;
    this.isStepping = isOf(target);
    this.handButtons.forEach((button, i) => {
      button.disabled = !isOf(jog) && !this.isStepping;
      const way = `Move the hand ${i % 2 ? "along" : "against"} ${AXES[i >> 1]} ${this.isStepping ? "by one step" : "while held"}`;
      button.title = button.ariaLabel = way;
    });
    this.step.disabled = !this.isStepping;
    this.axes.disabled = (!isOf(jog) && !this.isStepping) || !store.can("change");
    this.startJog.hidden = Boolean(jog.controller) || !store.isOperator;
    this.startTarget.hidden = Boolean(target.controller) || !store.isOperator;
    if (isOf(jog) && jog.controller !== this.framed) this.askFrame(jog.controller);
    Object.values(this.speeds).forEach(({ input, tell }, i) => {
      const most = String(fastest ? fastest[i] : Object.values(MOST)[i]);
      if (input.max === most) return;
      input.max = most;
      tell();
    });
    if (message) show(this.state, units.words(`⚠ ${message}`));
    else if (isOf(jog)) show(this.state, `Hold a button: ${jog.controller} moves the hand in the axes of ${FRAMES[this.frame] ?? FRAMES[0]}.`);
    else if (isOf(target)) show(this.state, `${target.controller} moves the hand to a pose that you type here, by one step for each press of a button, or to where you drag the arrows at the hand in the 3D view.`);
    else show(this.state, "Start one of the two: a jog while a button is held, or targets that the hand goes to. What moves single joints stops then.");
  }
});
