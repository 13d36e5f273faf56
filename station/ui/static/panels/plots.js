// Plots: any channels of the streams or of a recording, several plots, zoom, cursor, marks, CSV.
import "./replay_bar.js";
import { described, numbersIn } from "../lib/channel_maths.js";
import { Channels, sample, sources } from "../lib/channels.js";
import { History } from "../lib/history.js";
import { button, choice, commonStart, h, html, kept, line, number, Panel, render, shortNames, show, store, units } from "../lib/panel.js";
import { layoutMenu, layoutOf } from "../lib/plot_layouts.js";
import { Plot, download, swatch } from "../lib/plot.js";
import { Run, ofLink } from "../lib/recorded.js";
import { replay } from "../lib/replay.js";
import { SPECTRUM, TRANSFORMS, transformed } from "../lib/transforms.js";

const DRAW_HZ = 15;
const DERIVATIVE = "d/dt ";
const SAMPLED = ["desired", "actual", "error", "output"];
const SHOWN_AT_FIRST = [["position"], ["effort"]];

customElements.define("st-plots", class Plots extends Panel {
  build() {
    this.channels = new Map(); // key to {label, unit}
    this.histories = new Map();
    this.streamed = new Channels((key, time, value) => this.history(key).add(time, value));
    this.plots = [];
    this.paused = false;
    this.shown = (key) => this.history(key); // the samples to draw: while paused, those of the pause
    this.pause = button("Pause", "Hold the picture; the robot goes on.", () => this.setPaused(!this.paused));
    const add = button("+ plot", undefined, () => {
      this.addPlot([]);
      this.keep();
    });
    const layouts = layoutMenu(() => this.settings(), (plots) => this.showSettings(plots));
    this.tools.append(this.pause, add, layouts);
    this.row = h("div", { class: "plots" });
    this.bar = h("st-replay-bar");
    this.bar.shown = () => this.range;
    this.bar.layout = layouts.linked;
    this.bar.addEventListener("compare-live", () => this.compareLive());
    this.append(this.bar, this.row);
    this.tools.prepend(this.bar.tools);
    replay.addEventListener("runs", () => this.showRuns());
    replay.addEventListener("samples", () => this.plots.forEach((entry) => this.apply(entry)));
    replay.addEventListener("change", () => this.plots.forEach(({ plot }) => replay.isOpen && (plot.fixed = replay.time)));
    store.addEventListener("marker", () => {
      if (!this.paused) for (const { plot } of this.plots) plot.markers = store.markers;
    });
    store.addEventListener("restart", () => {
      for (const history of this.histories.values()) history.clear();
    });
    units.addEventListener("change", () => this.plots.forEach((entry) => this.apply(entry)));
    setInterval(() => this.draw(), 1000 / DRAW_HZ);
  }

  /** Open what the address of the page names: a recording, its moment, and the plots. */
  async openLink() {
    const wanted = ofLink(location.hash);
    if (!wanted) return;
    const plots = wanted.layout && (await layoutOf(wanted.layout));
    if (plots) this.showSettings(plots);
    if ((await replay.open(wanted)) && wanted.other) await replay.open(wanted.other);
  }

  /** Lay what this page has seen of the robot over the recording that is open. */
  compareLive() {
    const end = store.stationTime;
    const run = new Run({ id: "last minute", begin: end - 60, end, events: store.markers.map(({ at, text }) => ({ time: at, text })) });
    for (const key of this.wanted) run.kept.set(key, this.history(key).copy());
    run.begin = Math.max(run.begin, ...[...run.kept.values()].flatMap(({ times }) => times.slice(0, 1)));
    replay.put(run, { isOther: true });
  }

  /** Draw the recordings that are open in place of the robot, or the robot again. */
  showRuns() {
    const wasOpen = this.pause.hidden;
    for (const entry of this.plots) {
      if (!wasOpen) entry.liveSpan = entry.plot.span;
      if (!replay.isOpen) entry.plot.span = entry.liveSpan ?? entry.plot.span;
    }
    const range = wasOpen && replay.isOpen ? this.range : [0, replay.duration];
    this.pause.hidden = replay.isOpen;
    this.setPaused(replay.isOpen);
    if (replay.isOpen) this.zoomTo(...range);
  }

  /** The time that the plots show while they hold a picture [s]. */
  get range() {
    const plot = this.plots[0]?.plot;
    return plot?.end == null ? [0, replay.duration] : [plot.end - plot.span, plot.end];
  }

  setPaused(paused) {
    this.paused = paused;
    this.isZoomed = false;
    show(this.pause, paused ? "Resume" : "Pause");
    this.pause.ariaPressed = paused;
    const frozen = new Map(); // what the histories were at the pause; the robot goes on
    this.shown = (key) => (paused ? frozen.get(key) ?? frozen.set(key, this.history(key).copy()).get(key) : this.history(key));
    for (const entry of this.plots) {
      Object.assign(entry.plot, this.held(paused));
      this.apply(entry);
    }
  }

  /** Return how a plot shows the robot, now or at the pause, or the recordings that are open. */
  held(paused = this.paused) {
    if (replay.isOpen) {
      const [begin, end] = this.range;
      return { end, span: end - begin, markers: replay.marks(), seek: (time) => replay.seek(time), fixed: replay.time, longest: replay.duration };
    }
    return { end: paused ? store.stationTime : null, markers: paused ? [...store.markers] : store.markers, seek: null, fixed: null, longest: undefined };
  }

  refresh() {
    this.listChannels();
    if (this.plots.length || !store.docks.joints.length) return;
    const saved = kept.get("plots-2", null);
    if (saved?.length) this.showSettings(saved);
    else
      for (const [quantity] of SHOWN_AT_FIRST)
        this.addPlot(store.docks.joints.slice(0, 7).map((joint) => `${quantity}/${joint}`));
    if (!this.isLinkOpened) this.openLink();
    this.isLinkOpened = true;
  }

  /** Show these plots in place of those that are there. */
  showSettings(plots) {
    for (const { plot } of this.plots) plot.forget();
    this.plots = [];
    this.row.replaceChildren();
    for (const { keys, xy, span, how, transform } of plots) this.addPlot(keys ?? [], xy, span, transform ?? how);
    this.keep();
  }

  /** Return the plots as the station keeps them. */
  settings() {
    return this.plots.map(({ keys, plot, how, liveSpan }) => ({ keys, xy: plot.xy, span: this.pause.hidden ? (liveSpan ?? 10) : plot.span, transform: how }));
  }

  listChannels() {
    const { joints, arms, operated } = store.docks;
    const key = [joints, arms.map((a) => a.arm_id), operated.names].join("|");
    if (key === this.listed) return;
    this.listed = key;
    this.streamed.want(this.wanted ?? []);
    const before = [...this.channels.keys()].join();
    this.channels.clear();
    const names = shortNames(joints);
    const units = { position: ["q", "rad"], velocity: ["dq", "rad/s"], effort: ["τ", "Nm"] };
    for (const [quantity, [symbol, unit]] of Object.entries(units))
      for (const joint of joints) this.channels.set(`${quantity}/${joint}`, { label: `${symbol} ${names.get(joint)}`, unit });
    for (const { arm_id: arm } of arms) {
      const prefixed = arms.length > 1 ? `${arm} ` : "";
      for (let i = 0; i < 7; i += 1) this.channels.set(`${arm}/tau_ext_hat_filtered/${i}`, { label: `${prefixed}τext joint${i + 1}`, unit: "Nm" });
      ["x", "y", "z"].forEach((axis, i) => this.channels.set(`${arm}/O_T_EE/${12 + i}`, { label: `${prefixed}hand ${axis}`, unit: "m" }));
      ["x", "y", "z"].forEach((axis, i) => this.channels.set(`${arm}/O_F_ext_hat_K/${i}`, { label: `${prefixed}force ${axis}`, unit: "N" }));
    }
    for (const field of SAMPLED)
      for (const element of operated.elements)
        this.channels.set(`sample/${field}/${element.name}`, { label: `${field} ${names.get(element.name) ?? element.name}`, unit: field === "output" ? "Nm" : element.unit });
    if (before !== [...this.channels.keys()].join()) for (const entry of this.plots) this.apply(entry);
  }

  history(key) {
    if (!this.histories.has(key)) this.histories.set(key, new History());
    return this.histories.get(key);
  }

  addPlot(keys, xy = false, span = 10, how = "") {
    const canvas = h("div", { class: "chart", tabIndex: 0, title: "Drag: zoom all plots to a range of time. Click, or Enter: a second cursor. Arrow keys: the first. Wheel, + and −: zoom. Double click: back.", role: "img" });
    const legend = h("div", { class: "legend", tabIndex: 0, role: "group", ariaLabel: "Channels of the plot" }); // long names are scrolled to
    const entry = { keys, legend, values: [], how, liveSpan: span };
    entry.plot = new Plot(canvas, { group: "plots", moved: () => this.tell(entry), chosen: (begin, end) => this.zoomTo(begin, end), zoomed: () => this.paused && this.zoomTo(entry.plot.end - entry.plot.span, entry.plot.end) });
    Object.assign(entry.plot, { xy, span }, this.held());
    const zoom = (factor) => {
      entry.plot.zoom(factor);
      this.keep();
    };
    const across = button("XY", "Draw the other channels over the first one instead of over time", () => {
      entry.plot.xy = !entry.plot.xy;
      this.apply(entry);
      across.ariaPressed = entry.plot.xy;
      this.keep();
    }, { ariaPressed: xy });
    const choose = () => {
      entry.how = transform.value;
      this.apply(entry);
      this.keep();
    };
    const transform = choice("Show", Object.entries(TRANSFORMS), choose, { title: "What is shown of the channels." });
    transform.value = how;
    const tools = line(
      button("−", "Show more time (or turn the wheel)", () => zoom(1.5)),
      button("+", "Show less time (or turn the wheel)", () => zoom(1 / 1.5)),
      across,
      transform,
      button("CSV", "Save what is shown", () => download("plot.csv", entry.plot.csv(store.stationTime))),
      button("✕", "Remove this plot", () => {
        this.plots = this.plots.filter((other) => other !== entry);
        entry.plot.forget();
        box.remove();
        this.keep();
      }),
    );
    const summary = h("summary", { title: "Channels, time shown, CSV, remove.", ariaLabel: "Choose channels" }, "⋯");
    entry.menu = h("details", { class: "picker", ontoggle: () => entry.menu.open && this.openMenu(entry) }, summary, h("div", {}, tools, h("div", { class: "choices" })));
    const dropping = { ondragover: (event) => this.dragged && event.preventDefault(), ondrop: (event) => this.drop(event, entry) };
    const box = h("div", { class: "plot", ...dropping }, h("div", { class: "plot-head" }, legend, entry.menu), canvas);
    canvas.addEventListener("dblclick", () => {
      if (replay.isOpen) return this.zoomTo(0, replay.duration);
      if (this.isZoomed) this.setPaused(false);
      for (const { plot } of this.plots) plot.span = 10;
      this.keep();
    });
    this.plots.push(entry);
    this.row.append(box);
    this.apply(entry);
  }

  /** Offer the usual channels, and every number of every source, which is asked for when it is opened. */
  openMenu(entry) {
    const recorded = replay.runs.slice(0, 1).map(({ name, columns }) => ({ id: "recorded", title: `recorded in ${name}`, columns: columns.slice(4) }));
    entry.groups = [...recorded, ...sources()].map((source) => ({ source, keys: null, isOpen: false }));
    const find = () => {
      this.drawMenu(entry);
      // What a quick source has is shown before a slow one has answered.
      if (entry.search.value.trim()) for (const group of entry.groups) this.load(group, entry);
    };
    entry.search = h("input", { type: "search", placeholder: "search, e.g. tau_J_d or p99", ariaLabel: "Search channels", oninput: find });
    this.drawMenu(entry);
  }

  drawMenu(entry) {
    const words = entry.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const channels = (keys) => keys.map((key) => [key, this.channel(key)]).map(([key, { label, unit }]) => [key, label, units.shown(unit).unit]);
    const isFound = ([, label, unit]) => words.every((word) => `${label} [${unit}] d/dt`.toLowerCase().includes(word));
    const rows = (keys) => channels(keys).filter(isFound).map((channel) => this.choice(entry, ...channel));
    const group = (one) => {
      const found = rows(one.keys ?? []);
      const none = one.keys ? "No numbers at the moment: a controller that does not run has none." : "Asking the station … What says nothing at the moment has no numbers here.";
      const toggle = ({ target }) => {
        one.isOpen = target.open;
        if (one.isOpen) this.load(one, entry);
      };
      return html`<details class="source" ?hidden=${words.length && !found.length} .open=${words.length ? found.length > 0 : one.isOpen} @toggle=${toggle}><summary>${one.source.title}</summary><div>${found.length ? found : html`<p class="hint">${none}</p>`}</div></details>`;
    };
    render(html`${entry.search}<div>${rows([...this.channels.keys()])}</div><p class="hint">Everything that is streamed:</p>${entry.groups.map(group)}`, entry.menu.querySelector(".choices"));
  }

  /** Ask a source for its numbers, once; again if it has had none. */
  async load(group, entry) {
    const { source } = group;
    if (group.isAsked) return;
    group.isAsked = true;
    const paths = source.columns ?? numbersIn((await sample(source)) ?? {});
    group.keys = paths.map((path) => `${source.id}|${path}`);
    group.isAsked = paths.length > 0;
    this.drawMenu(entry);
  }

  /** Return the row of a channel: a button for it, and one for its rate of change. */
  choice(entry, key, label, unit) {
    const choose = (wanted, name, text, look) => {
      const isChosen = entry.keys.includes(wanted);
      const change = () => {
        entry.keys = isChosen ? entry.keys.filter((other) => other !== wanted) : [...entry.keys, wanted];
        this.apply(entry);
        this.keep();
        this.drawMenu(entry);
      };
      return html`<button class=${look} type="button" aria-label=${name} aria-pressed=${isChosen} @click=${change}>${text}</button>`;
    };
    const text = unit ? `${label} [${unit}]` : label;
    return html`<div class="channel">${choose(key, text, text, "choice")}${choose(DERIVATIVE + key, `rate of change of ${label}`, "d/dt", "choice rate")}</div>`;
  }

  /** Hold the picture, and show a range of time [s] in all plots. */
  zoomTo(begin, end) {
    if (!this.paused) {
      this.setPaused(true);
      this.isZoomed = true;
    }
    for (const { plot } of this.plots) Object.assign(plot, { end, span: end - begin });
  }

  /** Let a channel that was dragged from the legend of another plot be one of this plot instead. */
  drop(event, entry) {
    if (!this.dragged || this.dragged.entry === entry) return;
    event.preventDefault();
    const { entry: from, key } = this.dragged;
    from.keys = from.keys.filter((other) => other !== key);
    entry.keys = [...entry.keys.filter((other) => other !== key), key];
    for (const changed of [from, entry]) this.apply(changed);
    this.keep();
  }

  /** Write the values at the cursor, else the newest ones, into the legend. */
  tell({ plot, values, time }) {
    const { cursor, fixed } = plot;
    const since = cursor === null || fixed === null || plot.isSpectrum ? "" : `, Δ ${number(cursor - fixed, 3)} s`;
    show(time, cursor === null ? "" : ` at ${number(cursor, 3)} ${plot.isSpectrum ? "Hz" : "s"}${since}`);
    plot.traces.forEach((trace, i) => {
      const { value, change } = plot.valueOf(trace);
      show(values[i], value === undefined ? "–" : number(value, 4) + (change === null ? "" : ` (Δ ${number(change, 4)})`));
    });
  }

  /** Return what a key stands for: a channel, or its rate of change. */
  channel(key) {
    const known = (name) => (name.includes("|") ? described(name) : this.channels.get(name));
    if (!key.startsWith(DERIVATIVE)) return known(key);
    const of = known(key.slice(DERIVATIVE.length));
    return of && { ...of, label: `d/dt ${of.label}`, unit: !of.unit ? "1/s" : of.unit.endsWith("/s") ? `${of.unit}²` : `${of.unit}/s` };
  }

  apply(entry) {
    const known = entry.keys.filter((key) => this.channel(key));
    entry.sources = this.sourcesOf(known);
    entry.made = null;
    this.transform(entry);
    const units = [...new Set(entry.plot.traces.map((t) => t.unit).filter(Boolean))].join(", ");
    const labels = entry.plot.traces.map((trace) => trace.label);
    const shared = commonStart(labels).slice(0, labels[0]?.length - 1); // each keeps something of its own
    const drawn = entry.sources.map(({ key }) => key);
    const keys = labels.length === drawn.length ? drawn : entry.how === "difference" ? drawn.slice(1) : [];
    entry.time = h("span", {});
    entry.values = labels.map(() => h("output", {}));
    const trace = (label, i) => html`<span class="trace t${i % 7}" title=${keys[i] ? `${label}; drag it to another plot` : label} draggable=${Boolean(keys[i])}
      @dragstart=${() => (this.dragged = { entry, key: keys[i] })} @dragend=${() => (this.dragged = null)}>${swatch(i)}${label.slice(shared.length)}${entry.values[i]}</span>`;
    render(html`<b>${!labels.length ? "no channel chosen" : units ? `${shared} [${units}]` : shared}${entry.time}</b>${labels.map(trace)}`, entry.legend);
    entry.plot.place.ariaLabel = `Plot of ${labels.join(", ")}`;
    this.note();
  }

  /** Return the channels with their samples: of the robot, or of every recording that is open. */
  sourcesOf(keys) {
    const source = (key, letter, read) => ({ ...this.channel(key), label: this.channel(key).label + letter, key, history: read(key.replace(DERIVATIVE, "")) });
    const runs = replay.isOpen ? replay.runs : [{ history: this.shown }];
    return runs.flatMap((run, i) => keys.map((key) => source(key, runs.length > 1 ? ` ${"AB"[i]}` : "", (name) => run.history(name))));
  }

  /** Make what is drawn of the channels; an XY plot has them as they are. */
  transform(entry) {
    const { plot, sources, how } = entry;
    const end = plot.end ?? store.stationTime;
    const made = [how, plot.xy, end, plot.span].join();
    if (made === entry.made) return; // a picture that is held needs no second look
    entry.made = made;
    plot.isSpectrum = how === SPECTRUM && !plot.xy;
    const channels = sources.map((source) => (source.key.startsWith(DERIVATIVE) ? { ...source, history: source.history.slopes() } : source));
    const traces = plot.xy ? channels : transformed(channels, how, end - plot.span, end);
    plot.traces = traces.map((trace) => ({ ...trace, ...units.shown(trace.unit) }));
  }

  keep() {
    kept.set("plots-2", this.settings());
    this.note();
  }

  /** Note which channels the plots need; a derivative needs the channel it is one of. */
  note() {
    const keys = this.plots.flatMap((entry) => entry.keys);
    this.wanted = new Set(keys.map((key) => key.replace(DERIVATIVE, "")));
    this.streamed.want(this.wanted);
    replay.want([...this.wanted]);
  }

  draw() {
    if (!this.isShown || document.hidden) return;
    for (const entry of this.plots) {
      this.transform(entry);
      entry.plot.draw(store.stationTime);
      this.tell(entry);
    }
  }
});
