// A plot of channels over another channel instead of over time.
import { number } from "./text.js";
import { COLOURS, FONT, dashOf, withRoom } from "./traces.js";

const LEFT = 46;
const BOTTOM = 16;

/** Round a step up to 1, 2 or 5 times a power of ten. */
function niceStep(rough) {
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
}

function drawGrid(pen, { width, height, style, x, y, begin, end, unit }, low, high) {
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

/** Draw all traces but the first over the first, on a canvas, from `begin` to `end` [s]. */
export function drawXy(canvas, traces, begin, end) {
  const style = getComputedStyle(canvas);
  const { clientWidth: width, clientHeight: height } = canvas;
  const ratio = devicePixelRatio;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = FONT;
  const [abscissa, ...others] = traces;
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
    return withRoom(low, high);
  };
  const [left, right] = range(0);
  const [low, high] = range(1);
  const x = (v) => LEFT + ((v - left) / (right - left)) * (width - LEFT - 4);
  const y = (v) => 4 + ((high - v) / (high - low)) * (height - BOTTOM - 8);
  drawGrid(pen, { width, height, style, x, y, begin: left, end: right, unit: abscissa.unit }, low, high);
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
