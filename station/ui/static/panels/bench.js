// The bench: tests of one joint, gains that a relay test proposes, and the kept runs.
import { act, angleField, button, choice, field, figure, h, html, kept, line, nameField, nothing, number, offer, Panel, peek, press, render, repeat, show, store, typed, units } from "../lib/panel.js";
import { BodePlot, COLOURS, Plot, responseTraces, swatch } from "../lib/plot.js";

/** What each kind of test asks for besides its size and duration. */
const EXCITATIONS = { step: [], sine: ["frequency"], chirp: ["first", "last"], multisine: ["frequencies"], relay: ["hysteresis", "relay_gain"] };
/** The size that each kind begins with [rad]: with more, a chirp comes near an arm's velocity limit, and below it friction hides a step. */
const SIZES = { step: 0.1, sine: 0.1, chirp: 0.02, multisine: 0.05, relay: 0.1 };
/** How long each kind lasts at first [s]. */
const TIMES = { step: 2, sine: 4, chirp: 8, multisine: 8, relay: 4 };
/** Figures: name, heading, factor and unit of what is shown, and its digits. */
export const FIGURES = [
  ["rise_time", "rise", 1e3, "ms", 0], ["overshoot", "overshoot", 100, "%", 1], ["settling_time", "settling", 1e3, "ms", 0],
  ["gain", "gain", 1, "", 3], ["phase", "phase", 1, "°", 1],
  ["bandwidth", "bandwidth", 1, "Hz", 2], ["resonance_peak", "peak gain", 1, "", 2], ["gain_margin", "gain margin", 1, "×", 2], ["phase_margin", "phase margin", 1, "°", 1],
  ["inertia", "inertia", 1, "kg m²", 3], ["damping", "damping", 1, "Nm s", 2], ["coherence", "coherence", 1, "", 3],
  ["period", "period", 1e3, "ms", 0], ["ultimate_gain", "ultimate gain", 1, "", 1], ["ultimate_period", "ultimate period", 1e3, "ms", 0],
  ["steady_error", "steady error", 1e3, "mrad", 2], ["rms_error", "RMS", 1e3, "mrad", 2], ["effort_peak", "torque peak", 1, "Nm", 1],
];
/** Return a figure of a run or a trial, in words. */
export const figureOf = ({ metrics }, [key, , factor, unit, digits]) => (metrics[key] == null ? "–" : figure(metrics[key] * factor, unit, digits));
const isSpectral = ({ bode }) => bode != null;

customElements.define("st-bench", class Bench extends Panel {
  build() {
    this.kind = choice("Kind of test", Object.keys(EXCITATIONS), () => this.choose());
    this.fields = {
      amplitude: angleField("size"),
      duration: field("for", "", "s"),
      frequency: field("at", "0.5", "Hz"),
      first: field("from", "0.5", "Hz"),
      last: field("to", "8", "Hz"),
      frequencies: field("at these", "0.5 0.9 1.5 2.3 3.7 5.9", "Hz"),
      hysteresis: angleField("hysteresis", 0.0005),
      relay_gain: field("p alone", "", "Nm/rad"),
    };
    this.fields.frequencies.input.classList.add("wide");
    const isTyped = new Set();
    for (const [name, { input }] of Object.entries(this.fields)) input.addEventListener("input", () => isTyped.add(name));
    this.choose = () => {
      const kind = this.kind.value;
      const used = ["amplitude", "duration", ...EXCITATIONS[kind]];
      for (const [name, { label }] of Object.entries(this.fields)) label.hidden = !used.includes(name);
      const p = this.tuning.gainsOfJoint().p;
      const usual = { amplitude: SIZES[kind], duration: TIMES[kind], relay_gain: p ? p / 4 : "" };
      for (const [name, value] of Object.entries(usual)) if (!isTyped.has(name)) this.fields[name].put(value);
    };
    this.runName = nameField("Name of the run", "name of the run", () => {});
    const rule = { needs: "motion", off: () => this.isMeasuring || !this.isTestable };
    this.runButton = button("Run test", "Moves the chosen joint through the running controller, at most 0.3 rad, and leads it back.", () => this.run(), { class: "s primary", ...rule });
    this.findButton = button("Find gains by relay", "Lets a relay with a quarter of p swing the joint, and proposes gains by named rules. Nothing is applied.", () => this.run("relay"), rule);
    const chart = (ariaLabel) => h("div", { class: "chart response", role: "img", ariaLabel });
    const time = chart("The shown runs over each other");
    const [gain, phase] = [chart("Gain of the shown runs over frequency"), chart("Phase of the shown runs over frequency")];
    this.response = new Plot(time);
    this.curve = choice("Curve of the Bode plot", ["closed loop", "open loop", "plant"], () => this.drawCurves());
    this.bodePlots = [new BodePlot(gain, "dB"), new BodePlot(phase, "°")];
    const bode = h("div", { class: "bode" }, line(h("b", {}, "Bode plot"), this.curve), gain, phase);
    Object.assign(this, { time, bode, table: h("div", { class: "scroll runs" }), proposals: h("div", {}) });
    this.state = h("p", { class: "hint", role: "status" });
    this.append(line(h("b", {}, "Test"), this.kind, ...Object.values(this.fields).map(({ label }) => label), this.runName, this.runButton, this.findButton), this.state, this.proposals, time, bode, this.table, this.buildPart());
    this.runs = [];
    this.curves = new Map();
    this.shown = new Set();
    this.colours = kept.get("bench-colours", {});
    this.choose();
    this.draw();
    units.addEventListener("change", () => this.draw());
    setInterval(() => {
      if (!this.isShown || !this.shown.size) return;
      if (!this.time.hidden) this.response.draw(this.response.end);
      if (!this.bode.hidden) for (const plot of this.bodePlots) plot.draw();
    }, 200);
  }

  /** The form that reads a part of a recording as a test. */
  buildPart() {
    this.source = choice("Recording to read", []);
    const kind = choice("Read as", Object.keys(EXCITATIONS));
    const [begin, end, low, high] = [field("from time", "", "s"), field("to time", "", "s"), field("lowest", "0.5", "Hz"), field("highest", "8", "Hz")];
    const read = button("Read", "Reads the chosen part as a test of the joint above; the robot does not move.", async () => {
      const [b, e, l, u] = [begin, end, low, high].map((one) => one.read());
      const body = { ...this.tuning.chosen, kind: kind.value, begin: b, end: e, low: l, high: u };
      if (this.runName.value.trim()) body.name = this.runName.value.trim();
      this.add(await act("POST", `${this.source.value}/bench`, body));
    }, { needs: "change", off: () => !this.source.value || [begin, end].some((one) => one.read() === null) });
    const listed = async (path) => ((await peek(path))?.recordings ?? []).map(({ identifier }) => [`${path}/${identifier}`, identifier]);
    const list = async ({ target }) => target.open && offer(this.source, (await Promise.all(["/recordings", "/incidents"].map(listed))).flat().reverse(), "none yet");
    return h("details", { ontoggle: list }, h("summary", {}, "A part of a recording"), line(this.source, kind, ...[begin, end, low, high].map(({ label }) => label), read));
  }

  /** Whether the chosen controller runs and takes positions of the chosen joint. */
  get isTestable() {
    const { controller, joint } = this.tuning.chosen;
    const { state, type } = store.controller(controller) ?? {};
    const { names = [], elements } = store.docks?.operated ?? {};
    const takesPositions = names.includes(controller) && elements.some(({ name, unit }) => name === joint && ["rad", "m"].includes(unit));
    return Boolean(joint) && (takesPositions || (state === "running" && type.endsWith("/JointTrajectoryController")));
  }

  refresh() {
    show(this.runButton, this.isMeasuring ? "Measuring …" : "Run test");
    if (!this.isListed && store.docks.link === "live") this.list();
  }

  async list() {
    this.isListed = true;
    const answer = await peek("/bench-runs");
    if (!answer) return (this.isListed = false);
    this.runs = answer.runs.reverse();
    return this.draw();
  }

  async run(kind = this.kind.value) {
    this.kind.value = kind;
    this.choose();
    const value = (name) => this.fields[name].read();
    const { controller, joint } = this.tuning.chosen;
    const excitation = { kind, joint, amplitude: value("amplitude") };
    for (const name of EXCITATIONS[kind]) if (name !== "relay_gain") excitation[name] = name === "frequencies" ? this.fields[name].input.value.trim().split(/[\s;]+/).map(typed) : value(name);
    const body = { excitation, duration: value("duration") };
    if (kind === "relay" && this.fields.relay_gain.input.value) body.relay_gain = value("relay_gain");
    if (this.runName.value.trim()) body.name = this.runName.value.trim();
    this.isMeasuring = true;
    this.refresh();
    const answer = await act("POST", `/controllers/${controller}/bench`, body);
    this.isMeasuring = false;
    this.refresh();
    await this.add(answer);
  }

  /** Show a new run over the one before of its sort. */
  async add(answer) {
    if (!answer) return;
    this.runName.value = "";
    this.curves.set(answer.name, answer);
    const before = [...this.shown].filter((name) => name !== answer.name && isSpectral(this.curves.get(name)) === isSpectral(answer)).slice(-1);
    this.shown = new Set([...before, answer.name]);
    await this.list();
    show(this.state, answer.kind === "relay" && !answer.proposals.length ? "No gains are proposed: the joint did not oscillate, or its i and d were in force. Give “p alone” a value, or a larger size." : "");
  }

  async toggle(name) {
    if (!this.shown.delete(name)) {
      if (!this.curves.has(name)) this.curves.set(name, await act("GET", `/bench-runs/${encodeURIComponent(name)}`));
      if (this.curves.get(name)) this.shown.add(name);
    }
    this.draw();
  }

  async remove(name) {
    if (!(await act("DELETE", `/bench-runs/${encodeURIComponent(name)}`))) return;
    this.shown.delete(name);
    this.curves.delete(name);
    delete this.colours[name];
    this.list();
  }

  /** The colour of a run, which it keeps while it is there: the one that the fewest have. */
  colourOf(name) {
    if (!(name in this.colours)) {
      const names = new Set(this.runs.map((run) => run.name));
      const used = Object.entries(this.colours).filter(([each]) => names.has(each)).map(([, colour]) => colour);
      this.colours[name] = used.length ? (Math.max(...used) + 1) % (4 * COLOURS) : 0;
      kept.set("bench-colours", this.colours);
    }
    return this.colours[name];
  }

  draw() {
    const shown = this.runs.filter(({ name }) => this.shown.has(name));
    const columns = FIGURES.filter(([key]) => shown.some(({ metrics }) => key in metrics));
    const row = (run) => html`<tr>
      <td><label class="trace t${this.colourOf(run.name) % COLOURS}"><input type="checkbox" .checked=${this.shown.has(run.name)} aria-label="Show ${run.name}" @change=${() => this.toggle(run.name)} />${swatch(this.colourOf(run.name))}${run.name}</label></td>
      <td>${run.kind} ${run.joint.replace(/^.*_/, "")}: ${Object.entries(run.gains).map(([key, value]) => `${key} ${number(value, Number.isInteger(value) ? 0 : 2)}`).join(", ") || "–"}</td>
      ${columns.map((column) => html`<td>${figureOf(run, column)}</td>`)}
      <td>${press("✕", "", () => this.remove(run.name), { needs: "change", name: `Delete ${run.name}` })}</td>
    </tr>`;
    render(this.runs.length ? html`<table class="metrics"><thead><tr><th>run</th><th>test</th>${columns.map(([, title]) => html`<th>${title}</th>`)}<th></th></tr></thead><tbody>${repeat(this.runs, ({ name }) => name, row)}</tbody></table>` : nothing, this.table);
    this.drawProposals();
    this.drawCurves();
  }

  /** Gains by rule, each beside those in force: what is applied is seen before the click. */
  drawProposals() {
    const run = [...this.shown].map((name) => this.curves.get(name)).findLast((one) => one?.proposals.length);
    const now = this.tuning.gains?.values ?? {};
    const change = ([name, value]) => html`<td>${number(now[name], 2)} → <b>${number(value, 2)}</b></td>`;
    const row = (proposal) => html`<tr title=${[proposal.source, proposal.note].filter(Boolean).join(". ")}>
      <td>${proposal.title}${proposal.note ? " *" : ""}</td>${Object.entries(proposal.gains).map(change)}
      <td>${press("Apply", "", () => this.apply(run, proposal), { look: "s primary", needs: "change", name: `Apply ${proposal.title}` })}</td>
    </tr>`;
    render(run ? html`<table class="metrics proposals"><thead><tr><th>rule</th>${Object.keys(run.proposals[0].gains).map((name) => html`<th>${name.split("/").at(-1)}</th>`)}<th></th></tr></thead><tbody>${run.proposals.map(row)}</tbody></table><p class="hint">${run.proposals.some(({ note }) => note) ? "* The integral acts once i_clamp_max is more than 0." : ""}</p>` : nothing, this.proposals);
  }

  async apply(run, proposal) {
    const done = await act("PATCH", `/controllers/${run.controller}/gains`, { values: proposal.gains });
    if (!done) return;
    await this.tuning.reread();
    show(this.state, `${proposal.title} applied: ${Object.entries(proposal.gains).map(([name, value]) => `${name} ${number(done.previous[name], 2)} → ${number(value, 2)}`).join(", ")}. Undo takes it back.`);
    this.drawProposals();
  }

  drawCurves() {
    const shown = [...this.shown].map((name) => this.curves.get(name)).filter(Boolean);
    const [spectral, timed] = [shown.filter(isSpectral), shown.filter((run) => !isSpectral(run))];
    this.bode.hidden = !spectral.length;
    this.time.hidden = !timed.length;
    const key = this.curve.value.replace(" ", "_");
    const colour = ({ name }) => this.colourOf(name);
    const curves = (read) => spectral.map((run) => ({ label: run.name, colour: colour(run), x: run.bode.frequency, y: read(run.bode[key]) }));
    this.bodePlots[0].set(curves(({ gain }) => gain.map((each) => 20 * Math.log10(each))));
    this.bodePlots[1].set(curves(({ phase }) => phase));
    const trace = (run, field, label, i) => {
      const forward = Math.sign(run.amplitude) || 1;
      return { label, time: run.time, values: run[field].map((value) => value != null ? (value - run.position[0]) * forward : null), colour: i };
    };
    const last = timed.at(-1);
    const traces = timed.map((run) => trace(run, "position", run.name, colour(run)));
    this.response.traces = responseTraces(last ? [...traces, trace(last, "desired", "command", colour(last) + 3)] : []);
    if (!last) return;
    this.response.end = Math.max(...timed.map(({ time }) => time.at(-1)));
    this.response.span = this.response.end || 1;
  }
});
