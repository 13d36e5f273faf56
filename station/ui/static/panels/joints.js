// Joints: where each is, what it is told, exact typed values, and hold-to-run buttons.
import { Channels } from "../lib/channels.js";
import { Forecast } from "../lib/forecast.js";
import { hideGhost, showGhost } from "../lib/ghost.js";
import { JointSlider } from "../lib/joint_slider.js";
import { act, button, choice, decide, DEGREES, h, holdButton, html, kept, line as lineOf, nameField, number, offer, Panel, peek, ranged, refusals, render, repeat, shortNames, show, store, teleoperation, typed, units, valueField } from "../lib/panel.js";

const NEAR_LIMIT = 0.05; // part of the range at each end
const POSITIONS = ["rad", "m"]; // units of what a held button can move
/** Where the station keeps the poses, and the seconds to one of them when they are played. */
const POSES = "/waypoint-paths/poses";
const POSE_S = 3;
const DRAW_HZ = 12;
const SHOW_SENT_MS = 500; // until the dashboard says how far it is
/** A typed value further away than this shows its ghost first [rad], [m]. */
const FAR = { rad: 20 / DEGREES, m: 0.1 };

/** The channel of what a joint is told by its controller. */
const desiredOf = (joint) => `sample/desired/${joint}`;

customElements.define("st-joints", class Joints extends Panel {
  build() {
    this.rows = new Map();
    this.newest = new Map(); // of the channels that the rows show, by their keys
    this.streamed = new Channels((key, _, value) => this.newest.set(key, value), DRAW_HZ);
    this.units = ["deg", "rad"].map((unit) => button(unit, undefined, () => units.choose(unit), { data: { unit } }));
    const choose = (value) => {
      kept.set("speed", value);
      teleoperation.mention(this.wantedSpeed); // for a motion that runs
    };
    this.speed = ranged("top speed", (value) => this.speedText(value), choose, { min: 2, max: 85, step: 1, value: kept.get("speed", 29), title: "Top speed of a joint on its way to a typed value, or while its button is held.", ariaLabel: "Top speed in degrees per second" });
    this.tools.append(...this.units, this.speed.label);
    this.table = h("div", { class: "scroll" });
    this.state = h("p", { class: "hint state" }, "Waiting for the station …");
    // The field keeps the focus, and with it Enter, while a button of the question is clicked.
    this.far = h("div", { class: "line far", role: "alert", hidden: true, onmousedown: (event) => event.preventDefault() });
    this.far.addEventListener("click", ({ target }) => target.closest("button") && this.forgetFar(), true);
    this.forecast = new Forecast();
    this.append(this.table, this.far, this.forecast.element, this.state, this.poses());
    units.addEventListener("change", () => this.showUnit());
    this.showUnit();
    store.addEventListener("joints", () => {
      const now = performance.now();
      if (now - this.drawnAt < 1000 / DRAW_HZ || !this.isShown || document.hidden) return;
      this.drawnAt = now;
      this.draw();
    });
    teleoperation.addEventListener("change", () => this.isShown && this.showState());
  }

  /** The poses are the waypoints of a path at the station. */
  poses() {
    this.kept = [];
    this.poseName = nameField("Name of the pose", "name", () => this.savePose(), { title: "Name under which the station keeps the present joints." });
    this.poseList = choice("Pose", [], undefined, { title: "Poses that the station keeps, as the waypoints of the path “poses”.", onpointerdown: () => this.readPoses() });
    const go = button("Go", "Move all joints to the pose, at the top speed above.", () => this.isAgreed(this.pose) && this.move(this.pose), { needs: "motion", off: () => !this.kept.length || !this.may });
    const off = () => !this.kept.length;
    const save = button("Save pose", "Keep where the joints are under this name.", () => this.savePose(), { needs: "change", off: () => !this.poseName.value.trim() });
    const forget = button("Forget", "Delete the pose from the station.", () => this.writePoses(this.kept.filter(({ name }) => name !== this.poseList.value)), { needs: "change", off });
    return lineOf("Poses", this.poseList, go, ...this.trials(() => this.pose, off), forget, this.poseName, save);
  }

  /** The buttons that try a motion before it is made; `targets()` are its ends, and they do nothing while `off()`. */
  trials(targets, off) {
    return this.forecast.trials(() => this.forecast.rehearseMove(targets(), this.wantedSpeed.joints), () => this.forecast.goAround(targets()), off);
  }

  async readPoses() {
    const paths = await peek("/waypoint-paths");
    // Asked for only when there are some: the console of a browser lists what is not found.
    const poses = paths?.waypoint_paths.includes("poses") ? await peek(POSES) : paths && { waypoints: [] };
    if (poses) this.kept = poses.waypoints;
    this.showPoses();
    return Boolean(poses);
  }

  showPoses() {
    offer(this.poseList, this.kept.map(({ name }) => name));
    decide();
  }

  async writePoses(waypoints) {
    const answer = await (waypoints.length ? act("PUT", POSES, { waypoints }) : act("DELETE", POSES));
    if (answer) this.kept = waypoints;
    this.showPoses();
    return answer;
  }

  async savePose() {
    const name = this.poseName.value.trim();
    if (!name || !(await this.readPoses())) return;
    const positions = Object.fromEntries([...this.rows].map(([joint, { position }]) => [joint, position]));
    if (!(await this.writePoses([...this.kept.filter((pose) => pose.name !== name), { name, duration: POSE_S, positions }]))) return;
    this.poseName.value = "";
    this.poseList.value = name;
    this.showPoses();
  }

  /** The joints of the chosen pose. */
  get pose() {
    const pose = this.kept.find(({ name }) => name === this.poseList.value)?.positions ?? {};
    return Object.fromEntries(Object.entries(pose).filter(([joint]) => this.rows.has(joint)));
  }

  /** Whether these values may be sent now: a far one is shown as a ghost, and sent when it is asked for again. */
  isAgreed(targets) {
    const away = Object.entries(targets).map(([joint, target]) => [joint, this.awayBy(joint, target)]);
    const far = away.filter(([, { size, most }]) => size > most);
    const key = JSON.stringify(targets);
    const isAgreed = !far.length || key === this.asked;
    this.forgetFar();
    if (isAgreed) return true;
    this.asked = key;
    const names = shortNames([...this.rows.keys()]);
    const ways = far.map(([joint, { text }]) => `${names.get(joint)} by ${text}`);
    const go = button("Move there", undefined, () => this.move(targets), { class: "s primary" });
    const leave = button("Leave it", undefined, () => this.contains(document.activeElement) && document.activeElement.select?.()); // to be typed over
    this.far.replaceChildren(h("span", {}, `This moves ${ways.join(", ")}. The ghost shows where; the same again moves the robot.`), go, ...this.trials(() => targets), leave);
    this.far.hidden = false;
    this.far.scrollIntoView({ block: "nearest" });
    showGhost(targets, "not sent yet");
    return false;
  }

  /** How far a value is from what its joint is told; what is no position, or is refused anyway, is near. */
  awayBy(joint, target) {
    const { element, limits, position } = this.rows.get(joint);
    const size = Math.abs(target - (this.newest.get(desiredOf(joint)) ?? position));
    const isRefused = limits && (target < limits[0] || target > limits[1]);
    if (isRefused || !POSITIONS.includes(element?.unit)) return { size: 0, most: Infinity };
    const isAngle = element.unit === "rad" && units.angle === "deg";
    const text = isAngle ? `${number(size * DEGREES, 1)}°` : `${number(size, 3)} ${element.unit}`;
    return { size, most: FAR[element.unit], text };
  }

  /** Take back what was asked: another value was typed, or it was decided. */
  forgetFar() {
    if (!this.asked) return;
    this.asked = "";
    this.far.hidden = true;
    hideGhost();
  }

  get wantedSpeed() {
    return { do: "speed", joints: Number(this.speed.input.value) / DEGREES };
  }

  move(targets) {
    this.movedAt = performance.now();
    teleoperation.say(this.wantedSpeed);
    teleoperation.say({ do: "go", targets });
  }

  showUnit() {
    for (const button of this.units) button.ariaPressed = button.dataset.unit === units.angle;
    for (const row of this.rows.values()) row.sent = null;
    this.speed.tell();
    this.drawTable();
  }

  drawTable() {
    const angle = units.sign.trim();
    const head = (text, title, look = "") => html`<th title=${title} class=${look}>${text}</th>`;
    const heads = [head("joint", ""), head(`q [${angle}]`, "Measured position"), head("command", "Type a value and press Enter"), head(`dq [${angle}/s]`, "Measured speed"), head("τ [Nm]", "Measured torque"), head("τext", "External torque as a Franka arm estimates it [Nm]; – for other joints", "ext"), head("hold", "Moves while it is held")];
    const rows = repeat(this.rows, ([joint]) => joint, ([joint, row]) => this.row(joint, row));
    render(html`<table class="joints ${store.docks?.arms.length === 0 ? "without-arm" : ""}"><thead><tr>${heads}</tr></thead><tbody>${rows}</tbody></table>`, this.table);
  }

  /** Return the two lines of a joint: its values, and its slider between its limits. */
  row(joint, { label, input, hold, slider, limits, unit, texts: [q, dq, tau, ext] }) {
    const text = (value) => (unit === "m" ? `${number(value, 3)} m` : `${number(value * units.scale, units.angle === "deg" ? 1 : 3)}${units.sign}`);
    const [low, high] = limits?.map(text) ?? ["no limit", "no limit"];
    return html`<tr title=${joint}><th scope="row">${label}</th><td class="q">${q}</td><td>${input}</td><td class="dq">${dq}</td><td class="tau">${tau}</td><td class="ext">${ext}</td><td class="holds">${hold}</td></tr>
      <tr class="slide"><td colspan="7"><div><small>${low}</small>${slider.element}<small>${high}</small></div></td></tr>`;
  }

  speedText(value) {
    const number = (value / DEGREES).toFixed(2);
    const slides = [...this.rows.values()].some(({ unit }) => unit === "m");
    return (units.angle === "deg" ? `${value} °/s` : `${number} rad/s`) + (slides ? `, ${number} m/s` : "");
  }

  refresh() {
    const docks = store.docks;
    const names = docks.joints;
    if (names.join() !== [...this.rows.keys()].join()) {
      this.rows = new Map([...shortNames(names)].map(([joint, label]) => [joint, this.makeRow(joint, label)]));
      this.speed.tell();
    }
    const { operated } = docks;
    const followed = [...operated.names, ...names].join();
    if (followed !== this.followed) {
      this.followed = followed;
      this.newest.clear();
      this.streamed.want([...this.rows].flatMap(([joint, { external }]) => [desiredOf(joint), ...(external ? [external] : [])]));
    }
    const may = (this.may = operated.names.length > 0 && !operated.reason && store.isOperator);
    if (docks.boot_id !== this.posesOf && docks.link === "live") {
      this.posesOf = docks.boot_id;
      this.readPoses();
    } else this.showPoses();
    for (const [joint, row] of this.rows) {
      const element = operated.elements.find((e) => e.name === joint);
      const usable = may && Boolean(element);
      row.element = element;
      row.input.disabled = !usable;
      row.slider.disabled = !usable || !POSITIONS.includes(element.unit);
      for (const button of row.hold) button.disabled = row.slider.isDisabled;
    }
    this.drawTable();
    this.showState();
  }

  showState() {
    show(this.state, this.stateText());
    this.state.classList.toggle("warn", Boolean(store.docks?.operated.reason) && store.isOperator);
  }

  stateText() {
    if (!store.docks) return "";
    const { operated, enabling } = store.docks;
    if (!store.isOperator) return "This session only watches. An operator's session moves joints.";
    if (operated.reason) {
      const offered = enabling?.name && !enabling.reason;
      return offered ? "Nothing that runs takes joint values. Click “Enable sliders” over the 3D view." : units.words(operated.reason);
    }
    const going = teleoperation.state.remaining ?? 0;
    // The distances of several joints have one number, which has a unit if all turn.
    if (going > 1e-6 && operated.elements.some((e) => e.unit === "m")) return "Moving.";
    if (going > 1e-6) return `Moving: ${number(going * units.scale, 2)} ${units.angle} to go.`;
    return `${operated.names.join(" and ")} ${operated.names.length > 1 ? "take" : "takes"} values: type one and press Enter, or hold − and +.`;
  }

  makeRow(joint, label) {
    const limits = store.docks.limits[joint];
    const unit = store.docks.sliding.includes(joint) ? "m" : "rad";
    const input = valueField(`Command of ${label}`, () => this.send(joint, row), () => this.forgetFar());
    const move = (target) => {
      row.sent = null;
      this.forgetFar();
      this.move({ [joint]: target });
    };
    const pick = (target) => this.isAgreed({ [joint]: target }) && this.move({ [joint]: target });
    const look = (target) => (target === null ? hideGhost() : showGhost({ [joint]: target }, "where you drag it"));
    const slider = new JointSlider({ label, limits, unit, move, pick, show: look });
    const arm = store.docks.arms.find(({ arm_id: id }) => joint.startsWith(`${id}_joint`))?.arm_id;
    const external = arm && `${arm}/tau_ext_hat_filtered/${Number(joint.slice(-1)) - 1}`;
    const row = { label, slider, input, limits, unit, external, sent: null, position: 0, texts: [] };
    const jog = (sign) => () => {
      if (!row.told_speed) teleoperation.say(this.wantedSpeed);
      row.told_speed = true;
      row.sent = null;
      teleoperation.say({ do: "jog", joint, sign });
    };
    const letGo = () => {
      row.told_speed = false;
      teleoperation.say({ do: "release" });
    };
    row.hold = [holdButton("−", `Move ${label} down while held`, jog(-1), letGo), holdButton("+", `Move ${label} up while held`, jog(1), letGo)];
    return row;
  }

  send(joint, row) {
    const value = typed(row.input.value);
    if (value === null) return refusals.add({ code: "not_a_number", detail: `“${row.input.value}” is not a number.`, remedy: "Type a number such as 0.3217 or 18.43." });
    const target = value / this.scaleOf(row.element);
    if (!this.isAgreed({ [joint]: target })) return;
    row.sent = { text: row.input.value.trim(), target, at: performance.now() };
    row.input.edited = false;
    this.move({ [joint]: target });
    row.input.select();
  }

  scaleOf(element) {
    return element?.unit.startsWith("rad") ? units.scale : 1;
  }

  draw() {
    const { name, position, velocity, effort } = store.joints;
    for (const [joint, row] of this.rows) {
      const i = name.indexOf(joint);
      if (i < 0) continue;
      row.position = position[i];
      const [scale, digits, fewer] = row.unit === "m" ? [1, 4, 3] : [units.scale, ...(units.angle === "deg" ? [2, 1] : [4, 3])];
      row.texts = [number(position[i] * scale, digits) + (row.unit === "m" ? " m" : ""), number(velocity[i] * scale, fewer), number(effort[i], 1), number(this.newest.get(row.external), 1)];
      const command = this.newest.get(desiredOf(joint)) ?? null;
      this.drawSlider(row, POSITIONS.includes(row.element?.unit) ? command : null, scale, digits);
      this.drawCommand(row, command, digits);
    }
    this.drawTable();
  }

  /** Whether the robot is on its way to what was sent then. */
  isGoing(sentAt) {
    return teleoperation.state.remaining > 1e-6 || performance.now() - sentAt < SHOW_SENT_MS;
  }

  drawSlider({ slider, position, unit, limits }, command, scale, digits) {
    slider.update(position, command, this.isGoing(this.movedAt), number((command ?? position) * scale, digits) + (unit === "m" ? " m" : units.sign));
    const part = slider.part(position);
    slider.element.classList.toggle("near", Boolean(limits) && (part < NEAR_LIMIT || part > 1 - NEAR_LIMIT));
  }

  drawCommand(row, value, digits) {
    if (row.input.edited) return;
    if (value === null) return void (row.input.value = "");
    // What a person typed stays as typed while it is what the robot is told.
    if (row.sent && !this.isGoing(row.sent.at) && Math.abs(row.sent.target - value) >= 1e-9) row.sent = null;
    const text = row.sent?.text ?? number(value * this.scaleOf(row.element), digits);
    if (row.input.value === text) return;
    row.input.value = text;
    if (document.activeElement === row.input) row.input.select(); // to be typed over
  }
});
