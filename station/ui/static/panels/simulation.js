// Simulation: pause, step, speed, reset, pushes and faults, and where the objects of the
// scene are (their own panel); absent on a real robot.
import "./scene_objects.js";
import { act, api, choice, h, html, nameField, nothing, number, offer, Panel, press, refusals, store, typed } from "../lib/panel.js";

const FAULTS = ["collision", "lost_packets", "delayed_cycle", "nan_sensor", "stuck_joint"];
const LOOK_MS = 500;

customElements.define("st-simulation", class Simulation extends Panel {
  build() {
    this.done = "";
    const value = { class: "value", inputMode: "decimal" };
    this.steps = h("input", { ...value, value: "100", inputMode: "numeric", ariaLabel: "Cycles to step" });
    this.factor = nameField("Speed of simulated time", "", () => this.setFactor(), { ...value, value: "1" });
    this.keyframe = choice("Where the reset goes to", []);
    this.arm = choice("Arm of the fault or push", []);
    this.fault = choice("Fault", FAULTS.map((name) => [name, name.replaceAll("_", " ")]));
    this.force = h("input", { class: "value force", value: "0, 0, 20", ariaLabel: "Force of the push, x, y, z [N]" });
    this.every(LOOK_MS, () => store.docks.simulation && this.arm.value && this.look());
  }

  /** Ask which faults are active: they end by themselves, too. */
  async look() {
    this.faults = (await api("GET", `/robots/${this.arm.value}/faults`)).faults;
  }

  /** Ask for something and say what was done; nothing when it was refused, which the log says. */
  async ask(method, path, body, text) {
    this.done = (await act(method, path, body)) ? text : "";
    store.refresh();
  }

  stepOn() {
    const cycles = typed(this.steps.value);
    if (Number.isInteger(cycles) && cycles > 0) this.ask("POST", "/simulation/step", { n: cycles }, cycles === 1 ? "Stepped one cycle." : `Stepped ${cycles} cycles.`);
    else refusals.add({ code: "not_a_number", detail: `“${this.steps.value}” is not a whole number of cycles.`, remedy: "Type a whole number such as 100." });
  }

  setFactor() {
    const factor = typed(this.factor.value);
    if (factor === null) refusals.add({ code: "not_a_number", detail: `“${this.factor.value}” is not a number.` });
    else this.ask("PATCH", "/simulation", { real_time_factor: factor }, `Speed set to × ${factor}.`);
  }

  push() {
    const force = this.force.value.split(",").map(Number);
    if (force.length !== 3 || force.some(Number.isNaN)) refusals.add({ code: "not_a_number", detail: "Type the force as three numbers, x, y, z [N]." });
    else act("POST", `/robots/${this.arm.value}/external_force`, { link: `${this.arm.value}_hand`, force, duration: 0.3 });
  }

  inject() {
    const body = this.fault.value === "collision" ? { kind: "collision", cycles: 30 } : { kind: this.fault.value };
    act("POST", `/robots/${this.arm.value}/faults`, body).then(() => this.look());
  }

  view() {
    const { simulation, arms } = store.docks;
    if (!simulation) return nothing; // the dock goes, too
    const { paused } = simulation;
    offer(this.keyframe, [["", "start"], ...simulation.keyframes]);
    offer(this.arm, arms.map((arm) => arm.arm_id), "no arm");
    this.arm.hidden = arms.length < 2;
    return html`<p class="hint state">${paused ? "‖ paused" : "▶ running"} at × ${number(simulation.real_time_factor, 2)} · ${number(simulation.time, 1)} s</p>
      <p class="hint" role="status">${this.done}</p>
      <div class="line">${press(paused ? "Resume" : "Pause", "Simulated time stands still; stops and switches still work.", () => this.ask("PATCH", "/simulation", { paused: !paused }, paused ? "Resumed." : "Paused."), { needs: "change" })}
        ${press("Step", "Run so many cycles while paused.", () => this.stepOn(), { needs: "change", off: !paused })}${this.steps}cycles</div>
      <div class="line"><label>speed × ${this.factor}</label>${press("Set", "Simulated seconds per second.", () => this.setFactor(), { needs: "change" })}</div>
      <div class="line">${press("Reset", "Put the world back; earlier set-points and goals are void.", () => this.ask("POST", "/simulation/reset", { keyframe: this.keyframe.value || null }, "Simulation reset."), { needs: "change" })} to ${this.keyframe}</div>
      <div class="line" ?hidden=${!arms.length}>${this.arm}${press("Push hand", "Push the hand for 0.3 s.", () => this.push(), { needs: "change" })}${this.force} N</div>
      <div class="line" ?hidden=${!arms.length}>${press("Inject fault", "For exercises: the arm reacts as to a real one.", () => this.inject(), { needs: "change" })}${this.fault}
        ${press("End faults", "End all faults and pushes.", () => act("DELETE", `/robots/${this.arm.value}/faults`).then(() => this.look()), { needs: "change", off: () => !this.faults?.length })}${press("User stop", "Press the user stop of the arm.", () => act("POST", `/robots/${this.arm.value}/user_stop`, { pressed: true }), { needs: "change", off: () => store.isArmIn("user_stopped", this.arm.value) })}</div>
      <st-scene-objects></st-scene-objects>`;
  }
});
