// "Tune for me": a search for better gains in a simulated copy of the station, its
// progress and its best so far; nothing is applied before a person has seen the change.
import { act, angleField, api, field, h, html, number, Panel, press, refusals } from "../lib/panel.js";
import { Plot, responseTraces } from "../lib/plot.js";
import { FIGURES, figureOf } from "./bench.js";

const LOOK_MS = 1000;
const SHOWN = FIGURES.filter(([key]) => ["rise_time", "overshoot", "settling_time", "rms_error", "effort_peak"].includes(key));

/** Return the name of the newest search among experiments, or nothing. */
const newestOf = (experiments) => experiments.filter(({ kind }) => kind === "tune").sort((a, b) => b.created_at.localeCompare(a.created_at))[0]?.name ?? "";

customElements.define("st-tune-search", class TuneSearch extends Panel {
  build() {
    this.fields = { trials: field("trials", "40", "", "Number of trials of the search"), size: angleField("step", 0.1, "step of the search"), seconds: field("for", "1", "s", "for of the search [s]") };
    this.chart = h("div", { class: "chart response", role: "img", ariaLabel: "Responses at the start of the search and of the best trial" });
    this.plot = new Plot(this.chart);
    this.name = this.differs = "";
    this.refresh();
    setInterval(() => this.isShown && this.shown?.best && this.plot.draw(this.plot.end), 250);
    this.every(LOOK_MS, () => this.look());
  }

  async start() {
    const { controller, joint } = this.tuning.chosen;
    const [trials, size, seconds] = ["trials", "size", "seconds"].map((key) => this.fields[key].read());
    if ([trials, size, seconds].includes(null)) return refusals.add({ code: "not_a_number", detail: "Type trials, step and seconds as numbers." });
    this.isStarting = true;
    this.refresh();
    const commands = [{ kind: "step", joint, amplitude: size }];
    const answer = await act("POST", "/experiments", { kind: "tune", controller, joints: joint ? [joint] : null, trials, duration: seconds, commands });
    this.isStarting = false;
    if (!answer) return this.refresh();
    Object.assign(this, { joint, name: answer.name, drawnBest: null });
    this.show(answer);
  }

  get url() {
    return `/experiments/${encodeURIComponent(this.name)}`;
  }

  async look() {
    if (this.shown && this.shown.state !== "running") return;
    this.name ||= newestOf((await api("GET", "/experiments")).experiments);
    // An experiment that was deleted is none.
    const answer = this.name && (await api("GET", this.url).catch((error) => error.status === 404 && (this.name = "")));
    if (answer) this.show(answer);
    else this.shown = undefined;
  }

  show(answer) {
    this.shown = answer;
    if (answer.best && answer.best.hash !== this.drawnBest) this.readBest(answer);
    this.refresh();
  }

  /** Return how far the search is, in words. */
  progressOf({ name, controller, state, ended, trials, failed, cost, left, reason }) {
    const better = cost == null ? "" : ` · cost ${number(cost, 3)} of the start's`;
    const ahead = state === "running" && left != null ? ` · ${number(left, 0)} s left` : "";
    return `${name}, ${controller}: ${state}${reason ? `: ${reason}` : ""} · ${ended} of ${trials} trials${failed ? `, ${failed} failed` : ""}${better}${ahead}`;
  }

  view() {
    const answer = this.shown;
    const running = answer?.state === "running";
    const row = (one) => html`<tr><td>${one[1]}</td>${[answer.first, answer.best].map((trial) => html`<td>${trial ? figureOf(trial, one) : "–"}</td>`)}</tr>`;
    const says = answer ? this.progressOf(answer) : "Tries gains in a simulated copy of this station, in a process of its own; the robot stays as it is. You see the change before it is applied.";
    return html`<div class="line"><b>Search</b>${Object.values(this.fields).map(({ label }) => label)}
        ${press("Tune for me", "Search better gains of the chosen joint in a simulated copy of this station; the robot does not move", () => this.start(), { look: "s primary", needs: "change", off: () => this.isStarting || this.shown?.state === "running" || !this.tuning?.chosen.controller })}
        ${running ? press("Cancel search", "End the search; the best so far stays", () => act("POST", `${this.url}/cancel`).then((answer) => answer && this.show(answer)), { needs: "change" }) : ""}</div>
      <progress max="1" value=${answer?.trials ? answer.ended / answer.trials : 0} ?hidden=${!running} aria-label="Progress of the search"></progress>
      <p class="hint state" role="status">${this.isStarting ? "Starting a process for the trials …" : says}</p>
      <div ?hidden=${!answer?.best}>${this.chart}<table class="metrics"><thead><tr><th></th><th>at the start</th><th>best so far</th></tr></thead><tbody>${answer?.best ? SHOWN.map(row) : ""}</tbody></table></div>
      <div class="line">${answer?.best ? press("Preview gains …", "Show which gains would change", () => this.preview()) : ""}
        ${answer?.best && this.previewed ? press("Apply these", "Put the shown gains into force in one cycle; Undo takes them back", () => this.apply(), { look: "s primary", needs: "change" }) : ""}</div>
      <p class="hint">${this.differs}</p>`;
  }

  /** Read what the best trial has done; what was previewed was another one's. */
  async readBest(answer) {
    this.drawnBest = answer.best.hash;
    this.previewed = null;
    this.differs = "";
    // Without an answer the table says it; the next best trial is drawn again.
    const { responses = [] } = await api("GET", `${this.url}/responses`).catch(() => ({}));
    if (!responses.length) return;
    const rows = responses.map(({ role, joints, time, desired, position }, run) => {
      const i = Math.max(joints.indexOf(this.joint ?? this.tuning.chosen.joint), 0);
      const of = (label, values) => ({ label, time, values: values.map((row) => row?.[i]) });
      const own = of(role === "first" ? "at the start" : role, position);
      return run ? [own] : [of("command", desired), own];
    });
    this.plot.traces = responseTraces(rows.flat());
    const { time } = responses[0];
    this.plot.end = time.at(-1);
    this.plot.span = this.plot.end - time[0] || 1;
  }

  async preview() {
    const answer = await act("GET", `${this.url}/preview`);
    if (!answer) return;
    const lines = answer.differences.map((d) => `${d.controller} ${d.name}: ${number(d.present, 3)} → ${number(d.saved, 3)}`);
    this.previewed = lines.length ? answer : null;
    this.differs = lines.length ? `Would change ${lines.join("; ")}.` : "Nothing would change: these gains are in force.";
    this.refresh();
  }

  async apply() {
    const { trial, revisions } = this.previewed;
    const answer = await act("POST", `${this.url}/apply`, { trial, revisions });
    this.previewed = null;
    if (answer) this.differs = `Applied, and saved as the set “${this.name}”. Undo, above, takes them back.`;
    this.refresh();
    if (answer) this.tuning.reread();
  }
});
