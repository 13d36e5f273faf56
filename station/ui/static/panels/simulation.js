// Simulation: pause, step, speed, reset, pushes and faults, and where the objects of the
// scene are (their own panel); absent on a real robot.
import "./scene_objects.js";
import { button, h, line, offer, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { refusals } from "../lib/refusals.js";
import { act } from "../lib/station.js";
import { store } from "../lib/store.js";
import { number, typed } from "../lib/text.js";

const FAULTS = ["collision", "lost_packets", "delayed_cycle", "nan_sensor", "stuck_joint"];

class Simulation extends Panel {
  build() {
    this.state = h("p", { class: "hint state" });
    this.done = h("p", { class: "hint", role: "status" });
    this.pause = button("Pause", "Simulated time stands still; stops and switches still work.", () => this.changePause());
    this.steps = h("input", { class: "value", value: "100", inputMode: "numeric", ariaLabel: "Cycles to step" });
    this.step = button("Step", "Run so many cycles while paused.", () => this.stepOn());
    this.factor = h("input", { class: "value", value: "1", inputMode: "decimal", ariaLabel: "Speed of simulated time" });
    this.factor.addEventListener("keydown", (event) => event.key === "Enter" && this.setFactor());
    this.keyframe = h("select", { ariaLabel: "Where the reset goes to" });
    this.arm = h("select", { ariaLabel: "Arm of the fault or push" });
    this.fault = h("select", { ariaLabel: "Fault" }, ...FAULTS.map((name) => h("option", { value: name }, name.replaceAll("_", " "))));
    this.force = h("input", { class: "value force", value: "0, 0, 20", ariaLabel: "Force of the push, x, y, z [N]" });
    this.controls = h(
      "div",
      {},
      this.state,
      this.done,
      h("div", { class: "line" }, this.pause, this.step, this.steps, "cycles"),
      h("div", { class: "line" }, h("label", {}, "speed × ", this.factor), button("Set", "Simulated seconds per second.", () => this.setFactor())),
      h("div", { class: "line" }, button("Reset", "Put the world back; earlier set-points and goals are void.", () => this.act("/simulation/reset", { keyframe: this.keyframe.value || null }, "Simulation reset.")), " to ", this.keyframe),
      h("div", { class: "line arms" }, this.arm, button("Push hand", "Push the hand for 0.3 s.", () => this.push()), this.force, " N"),
      h("div", { class: "line arms" }, button("Inject fault", "For exercises: the arm reacts as to a real one.", () => this.inject()), this.fault, button("End faults", "End all faults and pushes.", () => act("DELETE", `/robots/${this.arm.value}/faults`)), button("User stop", "Press the user stop of the arm.", () => act("POST", `/robots/${this.arm.value}/user_stop`, { pressed: true }))),
    );
    this.append(this.controls, h("st-scene-objects"));
  }

  /** Say what was done; nothing when it was refused, which the log says. */
  say(told, text) {
    show(this.done, told ? text : "");
    store.refresh();
  }

  async act(path, body, text) {
    this.say(await act("POST", path, body), text);
  }

  async change(body, text) {
    this.say(await act("PATCH", "/simulation", body), text);
  }

  changePause() {
    const paused = !store.docks.simulation.paused;
    this.change({ paused }, paused ? "Paused." : "Resumed.");
  }

  stepOn() {
    const cycles = typed(this.steps.value);
    if (Number.isInteger(cycles) && cycles > 0) this.act("/simulation/step", { n: cycles }, cycles === 1 ? "Stepped one cycle." : `Stepped ${cycles} cycles.`);
    else refusals.add({ code: "not_a_number", detail: `“${this.steps.value}” is not a whole number of cycles.`, remedy: "Type a whole number such as 100." });
  }

  setFactor() {
    const factor = typed(this.factor.value);
    if (factor === null) refusals.add({ code: "not_a_number", detail: `“${this.factor.value}” is not a number.` });
    else this.change({ real_time_factor: factor }, `Speed set to × ${factor}.`);
  }

  push() {
    const force = this.force.value.split(",").map(Number);
    if (force.length !== 3 || force.some(Number.isNaN)) refusals.add({ code: "not_a_number", detail: "Type the force as three numbers, x, y, z [N]." });
    else act("POST", `/robots/${this.arm.value}/external_force`, { link: `${this.arm.value}_hand`, force, duration: 0.3 });
  }

  inject() {
    const body = this.fault.value === "collision" ? { kind: "collision", cycles: 30 } : { kind: this.fault.value };
    act("POST", `/robots/${this.arm.value}/faults`, body);
  }

  refresh() {
    const { simulation, arms } = store.docks;
    if (!simulation) return; // the dock goes, too
    show(this.state, `${simulation.paused ? "‖ paused" : "▶ running"} at × ${number(simulation.real_time_factor, 2)} · ${number(simulation.time, 1)} s`);
    show(this.pause, simulation.paused ? "Resume" : "Pause");
    this.step.disabled = !simulation.paused || !store.isOperator;
    const key = [...simulation.keyframes, ...arms.map((arm) => arm.arm_id)].join();
    if (key === this.listed) return;
    this.listed = key;
    offer(this.keyframe, [["", "start"], ...simulation.keyframes]);
    offer(this.arm, arms.map((arm) => arm.arm_id), "no arm");
    this.arm.hidden = arms.length < 2;
    for (const line of this.querySelectorAll(".arms")) line.hidden = !arms.length;
  }
}

customElements.define("st-simulation", Simulation);
