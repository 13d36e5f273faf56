// Charts drawn by uPlot: traces over time, over frequency or over one of them, with cursors, marks and zoom.
import { h, html, number, units } from "./panel.js";
import { History, csvOf } from "./history.js";
import uPlot from "../vendor/uplot/uPlot.esm.js";

const NEAR = 8; // pixels from a mark within which its text is shown
const SHORTEST = 0.2; // shown time [s]
const LONGEST = 60; // of the robot; a recording is shown as a whole
export const COLOURS = 7; // `--trace0` to `--trace6` in the style sheet
const FONT = "11px system-ui, 'DejaVu Sans', sans-serif";
const DASHES = [[], [6, 3], [2, 3], [8, 3, 2, 3]];

/** Return the dashes of a trace: no two of 28 traces have the same colour and dashes. */
export const dashOf = (i) => DASHES[((i % COLOURS) + Math.floor(i / COLOURS)) % DASHES.length];

/** Return a piece of a trace for the legend, dashed as in the plot. */
export const swatch = (i) => html`<svg aria-hidden="true"><line x1="0" y1="4" x2="12" y2="4" stroke-dasharray=${dashOf(i).join(" ")} /></svg>`;

/** Return the ends of an axis for values from `low` to `high`, if there are any. */
function withRoom(low, high) {
  if (!Number.isFinite(low)) return { min: -1, max: 1 };
  const room = Math.max((high - low) * 0.08, Math.max(Math.abs(high), 1) * 1e-3);
  return { min: low - room, max: high + room };
}

/** Return traces of responses {label, time, values, colour}, whose values may be missing. */
export function responseTraces(responses) {
  return responses.map(({ label, time, values, colour }) => {
    const history = new History(Infinity);
    time.forEach((at, i) => history.add(at, values[i]));
    return { label, history, colour, ...units.shown("rad") };
  });
}

/** Return the samples of all traces from `begin` to `end` over the same times. */
function aligned(traces, begin, end) {
  const parts = traces.map(({ history: { times, values }, history, scale = 1 }) => {
    // A sample more on each side, so that the lines reach the edges.
    const from = Math.max(history.indexAt(begin) - 1, 0);
    const to = history.indexAt(end) + 1;
    return [times.slice(from, to), values.slice(from, to).map((value) => value * scale)];
  });
  if (!parts.length) return [[]];
  const [[first]] = parts;
  const isSame = ([times]) => times.length === first.length && times[0] === first[0] && times.at(-1) === first.at(-1);
  return parts.every(isSame) ? [first, ...parts.map(([, values]) => values)] : uPlot.join(parts);
}

/** A chart that fills its `place`, made when there is room and something to draw. */
class Chart {
  constructor(place) {
    this.place = place;
    this.traces = []; // {label, colour, ...}; in the order of the colours without one
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.forget());
  }

  /** Begin anew, e.g. with other traces or colours. */
  forget() {
    this.chart?.destroy();
    this.chart = null;
  }

  /** Make the chart, or fit it to its place. */
  fit() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!this.chart) this.chart = new uPlot({ width, height, legend: { show: false }, padding: [6, 6, 0, 0], ...this.options() }, this.data(), this.place);
    else if (this.chart.width !== width || this.chart.height !== height) this.chart.setSize({ width, height });
  }

  /** Whether there is room for a chart. */
  get isRoomy() {
    return this.place.clientWidth >= 60 && this.place.clientHeight >= 40;
  }

  colour(name) {
    return getComputedStyle(this.place).getPropertyValue(name).trim();
  }

  /** Return the axes, whose values are written by `x` and `y`. */
  axes(x, y, space) {
    const axis = { stroke: this.colour("--dim"), font: FONT, grid: { stroke: this.colour("--line"), width: 1 }, ticks: { show: false } };
    return [{ ...axis, size: 18, gap: 2, space, values: x }, { ...axis, size: 46, gap: 3, space: 26, values: y }];
  }

  /** Return the series of the traces, the abscissa's before them. */
  series(pointsOf) {
    const series = ({ label, colour }, i) => ({ label, stroke: this.colour(`--trace${(colour ?? i) % COLOURS}`), width: 1.6, dash: dashOf(colour ?? i), points: pointsOf(this.traces[i]), spanGaps: true });
    return [{}, ...this.traces.map(series)];
  }
}

/** Curves {label, colour, x [Hz], y} over a logarithmic axis of frequencies; `unit` is that of the values. */
export class BodePlot extends Chart {
  constructor(place, unit) {
    super(place);
    this.unit = unit;
  }

  set(traces) {
    this.traces = traces;
    this.forget();
  }

  data() {
    return uPlot.join(this.traces.map(({ x, y }) => [x, y]));
  }

  options() {
    const texts = (unit) => (_, values) => values.map((value) => (value == null ? "" : number(value, Math.abs(value) < 1 && value ? 1 : 0) + unit));
    return {
      scales: { x: { time: false, distr: 3 } },
      axes: this.axes(texts(" Hz"), texts(` ${this.unit}`), 40),
      series: this.series(({ x }) => ({ show: x.length < 12, size: 5 })),
      cursor: { y: false, drag: { setScale: false }, sync: { key: "bode", setSeries: false, scales: ["x", null] } },
    };
  }

  draw() {
    if (this.isRoomy && this.traces.length) this.fit();
  }
}

/** Traces {label, history, unit, scale to it, colour} over time or frequency, or all but the first over the first. */
export class Plot extends Chart {
  /**
   * `place` is the element to draw into. Plots of one `group` share their cursor. `moved()` is
   * called when a cursor moves, `chosen(begin, end)` when a range of time is dragged [s], and
   * `zoomed()` when more or less of it is to be shown.
   */
  constructor(place, { group = "", moved = () => {}, chosen = () => {}, zoomed = () => {} } = {}) {
    super(place);
    Object.assign(this, { group, moved, chosen, zoomed });
    this.span = 10; // seconds shown
    this.end = null; // time at the right edge; null follows the newest sample
    this.cursor = null; // time of the cursor
    this.fixed = null; // time of the second cursor; the values tell their difference to it
    this.seek = null; // takes the time of a click instead of the second cursor, which is then set from outside
    this.longest = LONGEST; // most that is shown [s]
    this.isSpectrum = false; // whether the traces are over frequency [Hz]
    this.xy = false; // whether the first trace is the abscissa of the others
    this.markers = [];
    place.addEventListener("keydown", (event) => this.press(event));
    place.addEventListener("pointerdown", () => (this.isDragged = false));
    place.addEventListener("click", ({ target }) => target === this.chart?.over && !this.isDragged && this.fix());
    place.addEventListener("blur", () => this.chart?.setCursor({ left: -10, top: -10 }, true, true));
    place.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.25 : 0.8);
    }, { passive: false });
  }

  /** Put the second cursor where the first is, or take it away when it is there. */
  fix() {
    if (!this.isOverTime || (this.seek && this.cursor === null)) return;
    if (this.seek) return this.seek(this.cursor);
    const isThere = this.fixed !== null && this.cursor !== null && Math.abs(this.cursor - this.fixed) < this.span / 100;
    this.fixed = isThere ? null : this.cursor;
    return this.moved();
  }

  /** The keys of a plot: arrows move the cursor, Enter fixes the second, + and − zoom. */
  press(event) {
    const step = { ArrowLeft: -4, ArrowRight: 4 }[event.key];
    if (step && this.chart) {
      const { width, height } = this.chart.over.getBoundingClientRect();
      const before = this.chart.cursor.left >= 0 ? this.chart.cursor.left : width / 2;
      this.chart.setCursor({ left: Math.max(0, Math.min(before + step, width)), top: height / 2 }, true, true);
    } else if (event.key === "Enter") this.fix();
    else if (event.key === "+") this.zoom(0.8);
    else if (event.key === "-") this.zoom(1.25);
    else return;
    event.preventDefault();
  }

  /** Show more or less time: up to the newest sample, or around the cursor in a picture that is held. */
  zoom(factor) {
    const before = this.span;
    this.span = Math.min(Math.max(before * factor, SHORTEST), this.longest ?? LONGEST);
    if (this.end !== null && this.cursor !== null) this.end = this.cursor + ((this.end - this.cursor) * this.span) / before;
    this.zoomed();
  }

  forget() {
    this.drawn = null;
    super.forget();
  }

  data() {
    return this.isAcross ? [[0, 1]] : [[], ...this.traces.map(() => [])];
  }

  options() {
    const digits = (step) => Math.min(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), 5);
    const texts = (unit) => (_, values, __, ___, step) => values.map((value) => number(value, digits(step)) + unit);
    const range = (_, low, high) => Object.values(withRoom(low, high));
    const unit = this.isAcross ? this.traces[0].unit : this.isSpectrum ? "Hz" : "s";
    const [marker, dim] = [this.colour("--marker"), this.colour("--dim")];
    this.key = this.keyOf();
    return {
      scales: { x: { time: false, auto: false }, y: { range } },
      axes: this.axes(texts(` ${unit}`), texts(""), 70),
      series: this.isAcross ? [{}] : this.series(() => ({ show: false })),
      cursor: {
        show: !this.isAcross,
        y: false,
        points: { size: 6 },
        drag: { x: true, y: false, setScale: false },
        sync: this.group && this.isOverTime ? { key: this.group, setSeries: false, scales: ["x", null] } : {},
        bind: { dblclick: () => null },
      },
      hooks: {
        setCursor: [({ cursor }) => this.chart && this.hear(cursor.left)],
        setSelect: [(chart) => this.choose(chart)],
        draw: [(chart) => (this.isAcross ? this.drawAcross(chart) : this.drawMarks(chart, marker, dim))],
      },
    };
  }

  /** Whether the first trace is the abscissa of the others. */
  get isAcross() {
    return this.xy && this.traces.length > 1;
  }

  get isOverTime() {
    return !this.isAcross && !this.isSpectrum;
  }

  keyOf() {
    return JSON.stringify([this.isSpectrum, this.isAcross, ...this.traces.map(({ label, unit, colour }) => [label, unit, colour])]);
  }

  /** Note where the cursor is [px]; outside of the plot it is nowhere. */
  hear(left) {
    this.cursor = left >= 0 ? this.chart.posToVal(left, "x") : null;
    this.moved();
  }

  choose(chart) {
    const { left, width } = chart.select;
    if (width < 4) return;
    this.isDragged = true;
    if (this.isOverTime) this.chosen(chart.posToVal(left, "x"), chart.posToVal(left + width, "x"));
    chart.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  }

  /** Draw the plot; `newest` is the present station time [s]. */
  draw(newest) {
    if (!this.isRoomy) return;
    const end = this.end ?? newest;
    const begin = end - this.span;
    if (this.chart && this.key !== this.keyOf()) this.forget();
    this.fit();
    if (this.isAcross) return this.layAcross(begin, end);
    const held = JSON.stringify([this.end, this.span, this.chart.width, this.chart.height]);
    if (this.end !== null && this.drawn?.held === held && this.drawn.traces === this.traces) {
      if (this.drawn.fixed !== this.fixed || this.drawn.markers !== this.markers) this.chart.redraw(false);
      return void Object.assign(this.drawn, { fixed: this.fixed, markers: this.markers });
    }
    this.drawn = { held, traces: this.traces, fixed: this.fixed, markers: this.markers };
    const [min, max] = this.isSpectrum ? [0, Math.max(...this.traces.map(({ history }) => history.times.at(-1) ?? 0)) || 1] : [begin, end];
    this.chart.batch(() => {
      this.chart.setData(aligned(this.traces, min, max), false);
      this.chart.setScale("x", { min, max });
    });
    this.hear(this.chart.cursor.left); // the picture may have moved under the pointer
  }

  /** Lay all traces but the first over the first, from `begin` to `end` [s]. */
  layAcross(begin, end) {
    const [{ history: abscissa, scale: scaleX = 1 }, ...others] = this.traces;
    this.curves = others.map(({ history: { times, values }, history, scale = 1 }) => {
      const [from, to] = [history.indexAt(begin), history.indexAt(end)];
      const points = times.slice(from, to).map((time, i) => [abscissa.valueAt(time) * scaleX, values[from + i] * scale]);
      return points.filter(([x]) => !Number.isNaN(x));
    });
    const range = (axis) => {
      const all = this.curves.flat().map((point) => point[axis]);
      return withRoom(...all.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]));
    };
    this.chart.batch(() => {
      this.chart.setScale("x", range(0));
      this.chart.setScale("y", range(1));
      this.chart.redraw(false);
    });
  }

  /** Draw the curves over the first trace, with a square where each is now. */
  drawAcross(chart) {
    const { ctx: pen, bbox } = chart;
    const ratio = devicePixelRatio;
    const place = ([x, y]) => [chart.valToPos(x, "x", true), chart.valToPos(y, "y", true)];
    pen.save();
    pen.lineWidth = 1.6 * ratio;
    this.curves?.forEach((points, i) => {
      pen.strokeStyle = pen.fillStyle = this.colour(`--trace${(i + 1) % COLOURS}`);
      pen.setLineDash(dashOf(i + 1).map((part) => part * ratio));
      pen.beginPath();
      for (const point of points) pen.lineTo(...place(point));
      pen.stroke();
      if (!points.length) return;
      const [x, y] = place(points.at(-1));
      pen.fillRect(x - 3 * ratio, y - 3 * ratio, 6 * ratio, 6 * ratio);
    });
    pen.fillStyle = this.colour("--text");
    pen.font = FONT.replace("11px", `${11 * ratio}px`);
    pen.textAlign = "right";
    pen.fillText(`across: ${this.traces[0].label} [${this.traces[0].unit}]`, bbox.left + bbox.width - 6 * ratio, bbox.top + 12 * ratio);
    pen.restore();
  }

  /** Draw the marks of events, and the second cursor. */
  drawMarks(chart, colour, dim) {
    if (this.isSpectrum) return;
    const { ctx: pen, bbox } = chart;
    const ratio = devicePixelRatio;
    const { min, max } = chart.scales.x;
    const place = (time) => chart.valToPos(time, "x", true);
    const line = (x, dash) => {
      pen.setLineDash(dash.map((part) => part * ratio));
      pen.beginPath();
      pen.moveTo(x, bbox.top);
      pen.lineTo(x, bbox.top + bbox.height);
      pen.stroke();
    };
    pen.save();
    pen.lineWidth = ratio;
    pen.font = FONT.replace("11px", `${11 * ratio}px`);
    pen.strokeStyle = pen.fillStyle = colour;
    const at = chart.cursor.left >= 0 ? bbox.left + chart.cursor.left * ratio : -Infinity;
    for (const { at: time, until, text } of this.markers) {
      if ((until ?? time) < min || time > max) continue;
      const x = place(Math.max(time, min));
      if (until != null) {
        pen.globalAlpha = 0.15;
        pen.fillRect(x, bbox.top, place(Math.min(until, max)) - x, bbox.height);
        pen.globalAlpha = 1;
      }
      line(x, [2, 3]);
      pen.textAlign = "center";
      pen.fillText("▾", x, bbox.top + 8 * ratio);
      if (Math.abs(x - at) > NEAR * ratio) continue;
      const isRight = x > bbox.left + bbox.width / 2;
      pen.textAlign = isRight ? "right" : "left";
      pen.fillText(text, x + (isRight ? -6 : 6) * ratio, bbox.top + bbox.height - 6 * ratio);
    }
    pen.strokeStyle = dim;
    if (this.fixed !== null && this.fixed >= min && this.fixed <= max) line(place(this.fixed), []);
    pen.restore();
  }

  /** Return the value of a trace at the cursor, else its newest, and its difference to the second cursor. */
  valueOf({ history, scale = 1 }) {
    const at = this.cursor ?? (this.seek ? this.fixed : null);
    // A spectrum has no newest value.
    if (this.isSpectrum && this.cursor === null) return { value: undefined, change: null };
    const value = at === null ? history.values.at(-1) : history.nearest(at);
    const isCompared = this.cursor !== null && this.fixed !== null && !this.isSpectrum;
    return { value: value === undefined ? undefined : value * scale, change: isCompared ? (value - history.nearest(this.fixed)) * scale : null };
  }

  /** Return what the plot shows as CSV. */
  csv(newest) {
    const end = this.end ?? newest;
    return this.isSpectrum ? csvOf(this.traces, 0, Infinity, "frequency [Hz]") : csvOf(this.traces, end - this.span, end);
  }
}

/** Hand a text to the browser as a file. */
export function download(name, text, type = "text/csv") {
  const href = URL.createObjectURL(new Blob([text], { type }));
  h("a", { href, download: name }).click();
  URL.revokeObjectURL(href);
}
