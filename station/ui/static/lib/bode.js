// Curves over a logarithmic frequency axis, drawn by uPlot.
import { number } from "./text.js";
import { COLOURS, FONT, dashOf } from "./traces.js";
import uPlot from "../vendor/uplot/uPlot.esm.js";

export class BodePlot {
  /** `place` is the element to draw into, `unit` that of the values. */
  constructor(place, unit) {
    Object.assign(this, { place, unit, traces: [] });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.forget());
  }

  /** Show other traces {label, colour, x [Hz], y}. */
  set(traces) {
    this.traces = traces;
    this.forget();
  }

  forget() {
    this.chart?.destroy();
    this.chart = null;
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (width < 60 || height < 40 || !this.traces.length) return;
    if (!this.chart) this.make(width, height);
    else if (this.chart.width !== width || this.chart.height !== height) this.chart.setSize({ width, height });
  }

  make(width, height) {
    const style = getComputedStyle(this.place);
    const colour = (name) => style.getPropertyValue(name).trim();
    const axis = { stroke: colour("--dim"), font: FONT, grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false } };
    const texts = (unit) => (_, values) => values.map((value) => (value == null ? "" : number(value, Math.abs(value) < 1 && value ? 1 : 0) + unit));
    this.chart = new uPlot(
      {
        width,
        height,
        padding: [6, 8, 0, 0],
        legend: { show: false },
        scales: { x: { time: false, distr: 3 } },
        axes: [{ ...axis, size: 18, gap: 2, space: 40, values: texts(" Hz") }, { ...axis, size: 46, gap: 3, space: 26, values: texts(` ${this.unit}`) }],
        series: [{}, ...this.traces.map((trace) => ({ label: trace.label, stroke: colour(`--trace${trace.colour % COLOURS}`), width: 1.6, dash: dashOf(trace.colour), points: { show: trace.x.length < 12, size: 5 }, spanGaps: true }))],
        cursor: { y: false, drag: { setScale: false }, sync: { key: "bode", setSeries: false, scales: ["x", null] } },
      },
      uPlot.join(this.traces.map(({ x, y }) => [x, y])),
      this.place,
    );
  }
}
