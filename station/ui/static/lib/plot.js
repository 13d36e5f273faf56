// A plot over time, or over frequency, drawn by uPlot: traces, cursors, marks, zoom.
import { h } from "./dom.js";
import { csvOf } from "./history.js";
import { number } from "./text.js";
import { COLOURS, FONT, dashOf, withRoom } from "./traces.js";
import { drawXy } from "./xy_plot.js";
import uPlot from "../vendor/uplot/uPlot.esm.js";

const NEAR = 8; // pixels from a mark within which its text is shown
const SHORTEST = 0.2; // shown time [s]
const LONGEST = 60; // of the robot; a recording is shown as a whole

/** Return the samples of all traces from `begin` to `end` over the same times. */
function aligned(traces, begin, end) {
  const parts = traces.map(({ history: { times, values }, history }) => {
    // A sample more on each side, so that the lines reach the edges.
    const from = Math.max(history.indexAt(begin) - 1, 0);
    const to = history.indexAt(end) + 1;
    return [times.slice(from, to), values.slice(from, to)];
  });
  if (!parts.length) return [[]];
  const [[first]] = parts;
  const isSame = ([times]) => times.length === first.length && times[0] === first[0] && times.at(-1) === first.at(-1);
  return parts.every(isSame) ? [first, ...parts.map(([, values]) => values)] : uPlot.join(parts);
}

export class Plot {
  /**
   * `place` is the element to draw into. Plots of one `group` share their cursor. `moved()` is
   * called when a cursor moves, `chosen(begin, end)` when a range of time is dragged [s], and
   * `zoomed()` when more or less of it is to be shown.
   */
  constructor(place, { group = "", moved = () => {}, chosen = () => {}, zoomed = () => {} } = {}) {
    Object.assign(this, { place, group, moved, chosen, zoomed });
    this.span = 10; // seconds shown
    this.end = null; // time at the right edge; null follows the newest sample
    this.cursor = null; // time of the cursor
    this.fixed = null; // time of the second cursor; the values tell their difference to it
    this.seek = null; // takes the time of a click instead of the second cursor, which is then set from outside
    this.longest = LONGEST; // most that is shown [s]
    this.isSpectrum = false; // whether the traces are over frequency [Hz]
    this.xy = false; // whether the first trace is the abscissa of the others
    this.traces = []; // {label, history, unit, colour}; in the order of the colours without one
    this.markers = [];
    place.addEventListener("keydown", (event) => this.press(event));
    place.addEventListener("blur", () => this.chart?.setCursor({ left: -10, top: -10 }, true, true));
    place.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.25 : 0.8);
    }, { passive: false });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.forget());
  }

  /** Put the second cursor where the first is, or take it away when it is there. */
  fix() {
    if (this.isSpectrum) return undefined;
    if (this.seek) return this.cursor === null ? undefined : this.seek(this.cursor);
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

  /** Begin anew, e.g. with other traces or colours. */
  forget() {
    this.drawn = null;
    this.chart?.destroy();
    this.chart = null;
  }

  make(width, height) {
    const style = getComputedStyle(this.place);
    const colour = (name) => style.getPropertyValue(name).trim();
    const axis = { stroke: colour("--dim"), font: FONT, grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false } };
    const digits = (step) => Math.min(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), 5);
    const texts = (unit) => (_, values, __, ___, step) => values.map((value) => number(value, digits(step)) + unit);
    const sync = this.group && !this.isSpectrum ? { key: this.group, setSeries: false, scales: ["x", null] } : {};
    this.key = this.keyOf();
    this.chart = new uPlot(
      {
        width,
        height,
        padding: [6, 6, 0, 0],
        legend: { show: false },
        scales: { x: { time: false, auto: false }, y: { range: (_, low, high) => (low === null ? [-1, 1] : withRoom(low, high)) } },
        axes: [{ ...axis, size: 18, gap: 2, space: 70, values: texts(this.isSpectrum ? " Hz" : " s") }, { ...axis, size: 46, gap: 3, space: 26, values: texts("") }],
        series: [{}, ...this.traces.map(({ label, colour: paint }, i) => ({ label, stroke: colour(`--trace${(paint ?? i) % COLOURS}`), width: 1.6, dash: dashOf(paint ?? i), points: { show: false }, spanGaps: true }))],
        cursor: { y: false, points: { size: 6 }, drag: { x: true, y: false, setScale: false }, sync, bind: { dblclick: () => null } },
        hooks: {
          setCursor: [({ cursor }) => this.chart && this.hear(cursor.left)],
          setSelect: [(chart) => this.choose(chart)],
          draw: [(chart) => this.drawMarks(chart, colour("--marker"), colour("--dim"))],
        },
      },
      [[], ...this.traces.map(() => [])],
      this.place,
    );
    this.chart.over.addEventListener("click", () => this.isDragged || this.fix());
    this.chart.over.addEventListener("pointerdown", () => (this.isDragged = false));
  }

  keyOf() {
    return JSON.stringify([this.isSpectrum, ...this.traces.map(({ label, unit, colour }) => [label, unit, colour])]);
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
    if (!this.isSpectrum) this.chosen(chart.posToVal(left, "x"), chart.posToVal(left + width, "x"));
    chart.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  }

  /** Draw the plot; `newest` is the present station time [s]. */
  draw(newest) {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width < 60 || height < 40) return;
    const end = this.end ?? newest;
    this.shownEnd = end;
    const begin = end - this.span;
    if (this.xy && this.traces.length > 1) {
      this.forget();
      this.canvas ??= h("canvas");
      if (!this.canvas.isConnected) this.place.append(this.canvas);
      return drawXy(this.canvas, this.traces, begin, end);
    }
    this.canvas?.remove();
    if (this.chart && this.key !== this.keyOf()) this.forget();
    if (!this.chart) this.make(width, height);
    else if (this.chart.width !== width || this.chart.height !== height) this.chart.setSize({ width, height });
    const held = JSON.stringify([this.end, this.span, width, height]);
    if (this.end !== null && this.drawn?.held === held && this.drawn.traces === this.traces) {
      if (this.drawn.fixed !== this.fixed || this.drawn.markers !== this.markers) this.chart.redraw(false);
      Object.assign(this.drawn, { fixed: this.fixed, markers: this.markers });
      return undefined;
    }
    this.drawn = { held, traces: this.traces, fixed: this.fixed, markers: this.markers };
    const [min, max] = this.isSpectrum ? [0, Math.max(...this.traces.map(({ history }) => history.times.at(-1) ?? 0)) || 1] : [begin, end];
    this.chart.batch(() => {
      this.chart.setData(aligned(this.traces, min, max), false);
      this.chart.setScale("x", { min, max });
    });
    this.hear(this.chart.cursor.left); // the picture may have moved under the pointer
    return undefined;
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
  valueOf({ history }) {
    const at = this.cursor ?? (this.seek ? this.fixed : null);
    // A spectrum has no newest value.
    if (this.isSpectrum && this.cursor === null) return { value: undefined, change: null };
    const value = at === null ? history.values.at(-1) : history.nearest(at);
    return { value, change: this.cursor === null || this.fixed === null || this.isSpectrum ? null : value - history.nearest(this.fixed) };
  }

  /** Return what the plot shows as CSV. */
  csv(newest) {
    const end = this.end ?? newest;
    return this.isSpectrum ? csvOf(this.traces, 0, Infinity, "frequency [Hz]") : csvOf(this.traces, end - this.span, end);
  }
}

/** Hand a text to the browser as a file. */
export function download(name, text, type = "text/csv") {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
