// A small plot over time on a canvas: traces, a cursor, markers, zoom and pan.
import { csvOf } from "./history.js";
import { number } from "./text.js";

const COLOURS = 7; // `--trace0` to `--trace6` in the style sheet
const DASHES = [[], [6, 3], [2, 3], [8, 3, 2, 3]];
const LEFT = 46;
const BOTTOM = 16;

/** Return the dashes of a trace: no two of 28 traces have the same colour and dashes. */
export function dashOf(i) {
  return DASHES[((i % COLOURS) + Math.floor(i / COLOURS)) % DASHES.length];
}

/** Round a step up to 1, 2 or 5 times a power of ten. */
function niceStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
}

export class Plot {
  constructor(canvas) {
    this.canvas = canvas;
    this.span = 10; // seconds shown
    this.end = null; // time at the right edge; null follows the newest sample
    this.cursor = null; // x in pixels
    this.fixed = null; // time of the second cursor; the values tell their difference to it
    this.xy = false; // whether the first trace is the abscissa of the others
    this.traces = []; // {label, history, unit}
    this.markers = [];
    canvas.addEventListener("pointermove", (event) => {
      this.cursor = event.offsetX;
      if (event.buttons === 1 && this.end !== null)
        this.end -= (event.movementX * this.span) / (this.canvas.clientWidth - LEFT);
    });
    let pressedAt = 0;
    canvas.addEventListener("pointerdown", (event) => (pressedAt = event.clientX));
    canvas.addEventListener("click", (event) => Math.abs(event.clientX - pressedAt) < 4 && this.fix());
    canvas.addEventListener("pointerleave", () => (this.cursor = null));
    canvas.addEventListener("blur", () => (this.cursor = null));
    canvas.addEventListener("keydown", (event) => this.press(event));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.25 : 0.8);
    }, { passive: false });
  }

  /** Put the second cursor where the first is, or take it away when it is there. */
  fix() {
    const time = this.cursor === null ? null : this.timeAt(this.cursor);
    const isThere = this.fixed !== null && time !== null && Math.abs(time - this.fixed) < this.span / 100;
    this.fixed = isThere ? null : time;
  }

  /** The keys of a plot: arrows move the cursor, Enter fixes the second, + and − zoom. */
  press(event) {
    const step = { ArrowLeft: -4, ArrowRight: 4 }[event.key];
    if (step) this.cursor = Math.max(LEFT, Math.min((this.cursor ?? this.canvas.clientWidth / 2) + step, this.canvas.clientWidth));
    else if (event.key === "Enter") this.fix();
    else if (event.key === "+") this.zoom(0.8);
    else if (event.key === "-") this.zoom(1.25);
    else return;
    event.preventDefault();
  }

  timeAt(x) {
    return this.shownEnd - this.span + ((x - LEFT) / (this.canvas.clientWidth - LEFT - 4)) * this.span;
  }

  zoom(factor) {
    this.span = Math.min(Math.max(this.span * factor, 0.2), 60);
  }

  /** Draw the plot; `newest` is the present station time [s]. */
  draw(newest) {
    const style = getComputedStyle(this.canvas);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width < 20 || height < 20) return;
    const ratio = devicePixelRatio;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const pen = this.canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    const end = this.end ?? newest;
    this.shownEnd = end;
    const begin = end - this.span;
    if (this.xy && this.traces.length > 1) return this.drawXy(pen, { width, height, begin, end, style });
    const box = { width, height, begin, end, style, x: (t) => LEFT + ((t - begin) / this.span) * (width - LEFT - 4) };
    const [low, high] = this.bounds(begin, end);
    box.y = (v) => 4 + ((high - v) / (high - low)) * (height - BOTTOM - 8);
    this.drawGrid(pen, box, low, high);
    this.drawMarkers(pen, box);
    this.traces.forEach((trace, i) => this.drawTrace(pen, box, trace, i));
    if (this.cursor !== null) this.drawCursor(pen, box);
  }

  bounds(begin, end) {
    let low = Infinity;
    let high = -Infinity;
    for (const { history } of this.traces)
      for (let i = history.indexAt(begin); i < history.times.length && history.times[i] <= end; i += 1) {
        low = Math.min(low, history.values[i]);
        high = Math.max(high, history.values[i]);
      }
    if (!Number.isFinite(low)) return [-1, 1];
    const room = Math.max((high - low) * 0.08, Math.max(Math.abs(high), 1) * 1e-3);
    return [low - room, high + room];
  }

  drawGrid(pen, { width, height, style, x, y, begin, end, unit = "s" }, low, high) {
    pen.strokeStyle = style.getPropertyValue("--line");
    pen.fillStyle = style.getPropertyValue("--dim");
    pen.lineWidth = 1;
    pen.setLineDash([]);
    const step = niceStep((high - low) / Math.max(height / 44, 2));
    const digits = Math.max(0, -Math.floor(Math.log10(step)));
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (let v = Math.ceil(low / step) * step; v <= high; v += step) {
      pen.beginPath();
      pen.moveTo(LEFT, y(v));
      pen.lineTo(width, y(v));
      pen.stroke();
      pen.fillText(number(v, Math.min(digits, 5)), LEFT - 5, Math.max(y(v), 6));
    }
    pen.textAlign = "center";
    pen.textBaseline = "alphabetic";
    const tick = niceStep((end - begin) / Math.max(width / 90, 2));
    for (let t = Math.ceil(begin / tick) * tick; t <= end; t += tick) {
      pen.beginPath();
      pen.moveTo(x(t), 4);
      pen.lineTo(x(t), height - BOTTOM);
      pen.stroke();
      if (x(t) > LEFT + 12 && x(t) < width - 14) pen.fillText(`${number(t, Math.max(0, -Math.floor(Math.log10(tick))))} ${unit}`, x(t), height - 3);
    }
  }

  /** Draw all traces but the first over the first. */
  drawXy(pen, { width, height, begin, end, style }) {
    const [abscissa, ...others] = this.traces;
    const curves = others.map(({ history }) => {
      const points = [];
      for (let i = history.indexAt(begin); i < history.times.length && history.times[i] <= end; i += 1) {
        const j = Math.min(abscissa.history.indexAt(history.times[i]), abscissa.history.values.length - 1);
        if (j >= 0) points.push([abscissa.history.values[j], history.values[i]]);
      }
      return points;
    });
    const range = (k) => {
      const all = curves.flat().map((point) => point[k]);
      if (!all.length) return [-1, 1];
      const [low, high] = all.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
      const room = Math.max((high - low) * 0.08, Math.max(Math.abs(high), 1) * 1e-3);
      return [low - room, high + room];
    };
    const [left, right] = range(0);
    const [low, high] = range(1);
    const x = (v) => LEFT + ((v - left) / (right - left)) * (width - LEFT - 4);
    const y = (v) => 4 + ((high - v) / (high - low)) * (height - BOTTOM - 8);
    this.drawGrid(pen, { width, height, style, x, y, begin: left, end: right, unit: abscissa.unit }, low, high);
    curves.forEach((points, i) => {
      pen.strokeStyle = pen.fillStyle = style.getPropertyValue(`--trace${(i + 1) % COLOURS}`);
      pen.lineWidth = 1.6;
      pen.setLineDash(dashOf(i + 1));
      pen.beginPath();
      for (const [a, b] of points) pen.lineTo(x(a), y(b));
      pen.stroke();
      pen.setLineDash([]);
      const last = points.at(-1);
      if (last) pen.fillRect(x(last[0]) - 3, y(last[1]) - 3, 6, 6);
    });
    pen.fillStyle = style.getPropertyValue("--text");
    pen.textAlign = "right";
    pen.fillText(`across: ${abscissa.label} [${abscissa.unit}]`, width - 6, 14);
  }

  drawMarkers(pen, { height, style, x, begin, end }) {
    pen.strokeStyle = pen.fillStyle = style.getPropertyValue("--marker");
    pen.textAlign = "left";
    pen.setLineDash([2, 3]);
    for (const { at, text } of this.markers) {
      if (at < begin || at > end) continue;
      pen.beginPath();
      pen.moveTo(x(at), 4);
      pen.lineTo(x(at), height - BOTTOM);
      pen.stroke();
      pen.fillText("▾", x(at) - 4, 10);
      if (this.cursor !== null && Math.abs(x(at) - this.cursor) < 8) pen.fillText(text, x(at) + 6, height - BOTTOM - 6);
    }
  }

  drawTrace(pen, { style, x, y, begin, end, width }, { history }, i) {
    pen.strokeStyle = style.getPropertyValue(`--trace${i % COLOURS}`);
    pen.lineWidth = 1.6;
    pen.setLineDash(dashOf(i));
    pen.beginPath();
    const { times, values } = history;
    const first = Math.max(history.indexAt(begin) - 1, 0);
    // More points than pixels draw nothing more.
    let last = first;
    while (last < times.length && times[last] <= end) last += 1;
    const every = Math.max(1, Math.floor((last - first) / (width * 2)));
    pen.save();
    pen.rect(LEFT, 0, width - LEFT, 1e4);
    pen.clip();
    pen.beginPath();
    for (let j = first; j < last; j += every) pen.lineTo(x(times[j]), y(values[j]));
    pen.stroke();
    pen.restore();
    pen.setLineDash([]);
  }

  drawCursor(pen, { width, height, style, x: place }) {
    if (this.cursor < LEFT) return;
    const time = this.timeAt(this.cursor);
    const line = (at) => {
      pen.beginPath();
      pen.moveTo(at, 4);
      pen.lineTo(at, height - BOTTOM);
      pen.stroke();
    };
    pen.strokeStyle = style.getPropertyValue("--dim");
    line(this.cursor);
    if (this.fixed !== null) line(place(this.fixed));
    pen.fillStyle = style.getPropertyValue("--text");
    pen.textAlign = this.cursor > width / 2 ? "right" : "left";
    const x = this.cursor + (this.cursor > width / 2 ? -6 : 6);
    const since = this.fixed === null ? "" : ` (Δ ${number(time - this.fixed, 3)} s)`;
    pen.fillText(`${number(time, 2)} s${since}`, x, 14);
    const at = (history, when) => history.valueAt(when);
    this.traces.forEach(({ label, history, unit }, i) => {
      if (!history.values.length) return;
      const value = at(history, time);
      const change = this.fixed === null ? "" : ` (Δ ${number(value - at(history, this.fixed), 4)})`;
      pen.fillText(`${label}: ${number(value, 4)} ${unit}${change}`, x, 28 + 13 * i);
    });
  }

  /** Return what the plot shows as CSV. */
  csv(newest) {
    const end = this.end ?? newest;
    return csvOf(this.traces, end - this.span, end);
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
