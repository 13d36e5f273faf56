// "Tune for me": a search for better gains in a simulated copy of the station, its
// progress and its best so far; nothing is applied before a person has seen the change.
import { button, field, h, line, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { History } from "../lib/history.js";
import { Plot } from "../lib/plot.js";
import { refusals } from "../lib/refusals.js";
import { act, api } from "../lib/station.js";
import { store } from "../lib/store.js";
import { number, typed } from "../lib/text.js";

const LOOK_MS = 1000;
const SHOWN = [
  ["rms_error", "RMS error", 1e3, "mrad"],
  ["rise_time", "rise", 1e3, "ms"],
  ["overshoot", "overshoot", 100, "%"],
  ["settling_time", "settling", 1e3, "ms"],
  ["effort_peak", "torque peak", 1, "Nm"],
];

class TuneSearch extends Panel {
  build() {
    this.fields = { trials: field("trials", "40", "", "Number of trials of the search"), size: field("step", "0.1", "rad", "step of the search [rad]"), seconds: field("for", "1", "s", "for of the search [s]") };
    this.startButton = button("Tune for me", "Search better gains of the chosen joint in a simulated copy of this station; the robot does not move", () => this.start(), { class: "s primary" });
    this.cancelButton = button("Cancel search", "End the search; the best so far stays", () => this.act("cancel"));
    this.previewButton = button("Preview gains …", "Show which gains would change", () => this.preview());
    this.applyButton = button("Apply these", "Put the shown gains into force in one cycle; Undo takes them back", () => this.apply(), { class: "s primary" });
    this.progress = h("progress", { max: 1, value: 0, ariaLabel: "Progress of the search" });
    this.state = h("p", { class: "hint state", role: "status" }, "");
    this.diff = h("p", { class: "hint" });
    const chart = h("div", { class: "chart response", role: "img", ariaLabel: "Responses at the start of the search and of the best trial" });
    this.plot = new Plot(chart);
    this.rows = h("tbody", {});
    const heads = ["", "at the start", "best so far"].map((text) => h("th", {}, text));
    this.results = h("div", { hidden: true }, chart, h("table", { class: "metrics" }, h("thead", {}, h("tr", {}, ...heads)), this.rows));
    this.append(
      line(h("b", {}, "Search"), ...Object.values(this.fields).map(({ label }) => label), this.startButton, this.cancelButton),
      this.progress,
      this.state,
      this.results,
      line(this.previewButton, this.applyButton),
      this.diff,
    );
    this.name = "";
    this.show(null);
    setInterval(() => this.isShown && !this.results.hidden && this.plot.draw(this.plot.end), 250);
    this.every(LOOK_MS, () => this.look());
  }

  async start() {
    const { controller, joint } = this.tuning.chosen;
    const [trials, size, seconds] = ["trials", "size", "seconds"].map((key) => typed(this.fields[key].input.value));
    if ([trials, size, seconds].includes(null)) return refusals.add({ code: "not_a_number", detail: "Type trials, step and seconds as numbers." });
    this.startButton.disabled = true;
    show(this.state, "Starting a process for the trials …");
    const told = await act("POST", "/experiments", {
      kind: "tune",
      controller,
      joints: joint ? [joint] : null,
      trials,
      duration: seconds,
      commands: [{ kind: "step", joint, amplitude: size }],
    });
    if (!told) return this.refresh();
    this.joint = joint;
    this.name = told.name;
    this.drawnBest = null;
    this.show(told);
  }

  get url() {
    return `/experiments/${encodeURIComponent(this.name)}`;
  }

  async act(what) {
    const told = await act("POST", `${this.url}/${what}`);
    if (told) this.show(told);
  }

  async look() {
    if (this.shown && this.shown.state !== "running") return;
    this.name ||= await newest();
    // An experiment that was deleted is none.
    const told = this.name && (await api("GET", this.url).catch((error) => error.status === 404 && (this.name = "")));
    if (told) this.show(told);
    else this.shown = undefined;
  }

  refresh() {
    this.show(this.shown ?? null);
  }

  show(told) {
    this.shown = told;
    const running = told?.state === "running";
    this.startButton.disabled = running || !store.isOperator;
    this.cancelButton.hidden = !running;
    this.progress.hidden = !running;
    this.previewButton.hidden = !told?.best;
    this.results.hidden = !told?.best;
    if (!told?.best) this.applyButton.hidden = true;
    if (!told) return show(this.state, "Tries gains in a simulated copy of this station, in a process of its own; the robot stays as it is. You see the change before it is applied.");
    this.progress.value = told.trials ? told.ended / told.trials : 0;
    const better = told.cost == null ? "" : ` · cost ${number(told.cost, 3)} of the start's`;
    const left = running && told.left != null ? ` · ${number(told.left, 0)} s left` : "";
    const why = told.reason ? `: ${told.reason}` : "";
    show(this.state, `${told.name}, ${told.controller}: ${told.state}${why} · ${told.ended} of ${told.trials} trials${told.failed ? `, ${told.failed} failed` : ""}${better}${left}`);
    if (told.best && told.best.hash !== this.drawnBest) this.drawBest(told);
  }

  async drawBest(told) {
    this.drawnBest = told.best.hash;
    this.applyButton.hidden = true;
    show(this.diff, "");
    const cell = (trial, [key, , scale, unit]) => (trial?.metrics[key] == null ? "–" : `${number(trial.metrics[key] * scale, 2)} ${unit}`);
    this.rows.replaceChildren(...SHOWN.map((row) => h("tr", {}, ...[row[1], cell(told.first, row), cell(told.best, row)].map((text) => h("td", {}, text)))));
    let responses;
    try {
      ({ responses } = await api("GET", `${this.url}/responses`));
    } catch {
      return; // The table says it; the next best trial is drawn again.
    }
    const traces = [];
    for (const { role, joints, time, desired, position } of responses) {
      const i = Math.max(joints.indexOf(this.joint ?? this.tuning.chosen.joint), 0);
      const add = (label, rows) => {
        const history = new History(1e6);
        time.forEach((at, k) => history.add(at, rows[k]?.[i]));
        traces.push({ label, unit: "rad", history });
      };
      if (!traces.length) add("command", desired);
      add(role === "first" ? "at the start" : role, position);
    }
    if (!responses.length) return;
    this.plot.traces = traces;
    this.plot.end = responses[0].time.at(-1);
    this.plot.span = this.plot.end - responses[0].time[0] || 1;
  }

  async preview() {
    const told = await act("GET", `${this.url}/preview`);
    if (!told) return;
    this.previewed = told;
    const lines = told.differences.map((d) => `${d.controller} ${d.name}: ${number(d.present, 3)} → ${number(d.saved, 3)}`);
    show(this.diff, lines.length ? `Would change ${lines.join("; ")}.` : "Nothing would change: these gains are in force.");
    this.applyButton.hidden = !lines.length;
    this.applyButton.disabled = !store.isOperator;
  }

  async apply() {
    const { trial, revisions } = this.previewed;
    const told = await act("POST", `${this.url}/apply`, { trial, revisions });
    this.applyButton.hidden = true;
    if (!told) return;
    show(this.diff, `Applied, and saved as the set “${this.name}”. Undo, above, takes them back.`);
    this.tuning.reread();
  }
}

/** Return the name of the newest search of this station, or nothing. */
async function newest() {
  const { experiments } = await api("GET", "/experiments");
  const searches = experiments.filter((e) => e.kind === "tune");
  return searches.sort((a, b) => b.created_at.localeCompare(a.created_at))[0]?.name ?? "";
}

customElements.define("st-tune-search", TuneSearch);
