// What a plot may show in place of its channels; needs no page.
import { History } from "./history.js";

/** Time constant of smoothing [s]: faster than 1.6 Hz is damped. */
export const SMOOTHING = 0.1;
/** What is over frequency [Hz] instead of time. */
export const SPECTRUM = "spectrum";
const PADDING = 4; // times the samples: a peak between two frequencies loses less than 1.5 %
const SETTLED = 10; // time constants after which the first sample is forgotten

/** The transforms by what they are called in a saved plot. */
export const TRANSFORMS = { "": "channels as they are", smooth: "smoothed", difference: "minus the first", norm: "norm of all", spectrum: "spectrum" };

const within = ({ times, values }, from, to, take) => {
  for (let i = from; i < to; i += 1) take(times[i], values[i]);
};

/** Return the value of some samples at a time, straight between two of them; null beyond them. */
function interpolated({ times, values }, time, after) {
  if (after >= times.length) return null;
  if (times[after] === time) return values[after];
  if (after === 0) return null;
  const part = (time - times[after - 1]) / (times[after] - times[after - 1]);
  return values[after - 1] + part * (values[after] - values[after - 1]);
}

const at = (history, time) => interpolated(history, time, history.indexAt(time));

/** Transform complex numbers in place; their count is a power of two. */
function fft(re, im) {
  const n = re.length;
  for (let i = 1, j = 0; i < n; i += 1) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) [re[i], re[j], im[i], im[j]] = [re[j], re[i], im[j], im[i]];
  }
  for (let size = 2; size <= n; size *= 2)
    for (let k = 0; k < size / 2; k += 1) {
      const [cos, sin] = [Math.cos((2 * Math.PI * k) / size), -Math.sin((2 * Math.PI * k) / size)];
      for (let i = k; i < n; i += size) {
        const j = i + size / 2;
        const [a, b] = [re[j] * cos - im[j] * sin, re[j] * sin + im[j] * cos];
        [re[j], im[j], re[i], im[i]] = [re[i] - a, im[i] - b, re[i] + a, im[i] + b];
      }
    }
}

/**
 * Return the amplitudes of a channel from `begin` to `end` [s] over frequency [Hz]: a sine has
 * its own. Its mean is taken off, and Hann's window keeps strong frequencies from hiding others.
 */
function spectrum(source, begin, end) {
  const made = new History(Infinity);
  const from = source.indexAt(begin);
  const count = source.indexAt(end) - from;
  if (count < 8) return made;
  const [first, last] = [source.times[from], source.times[from + count - 1]];
  const period = (last - first) / (count - 1);
  // Streams have samples at almost even times; a recording has them at even ones.
  const values = Array.from({ length: count }, (_, i) => at(source, Math.min(first + i * period, last)));
  const mean = values.reduce((sum, value) => sum + value, 0) / count;
  const size = 2 ** Math.ceil(Math.log2(count * PADDING));
  const [re, im] = [new Float64Array(size), new Float64Array(size)];
  let weights = 0;
  values.forEach((value, i) => {
    const weight = 0.5 - 0.5 * Math.cos((2 * Math.PI * i) / count);
    weights += weight;
    re[i] = (value - mean) * weight;
  });
  fft(re, im);
  for (let k = 0; k <= size / 2; k += 1) made.add(k / (size * period), (2 * Math.hypot(re[k], im[k])) / weights);
  return made;
}

/** Return what is shown for traces {label, unit}, whose samples may be none yet. */
function shownAs(traces, how) {
  if (how === "smooth") return traces.map(({ label, unit }) => ({ label: `smoothed ${label}`, unit }));
  if (traces.length < 2) return traces;
  const [first, ...others] = traces;
  if (how === "difference") return others.map(({ label, unit }) => ({ label: `${label} − ${first.label}`, unit: unit === first.unit ? unit : "" }));
  if (how === "norm") return [{ label: `norm of ${traces.map(({ label }) => label).join(", ")}`, unit: others.every(({ unit }) => unit === first.unit) ? first.unit : "" }];
  return traces;
}

/**
 * Return the traces {label, unit, history} that are shown from `begin` to `end` [s]. A
 * difference or norm has a sample where all its channels have one, or lie between two.
 */
export function transformed(traces, how, begin, end) {
  if (how === SPECTRUM) return traces.map((trace) => ({ ...trace, history: spectrum(trace.history, begin, end) }));
  const made = shownAs(traces, how);
  if (made === traces) return traces;
  const sources = how === "smooth" ? traces : how === "difference" ? traces.slice(1) : [traces[0]];
  return made.map((trace, k) => {
    const history = new History(Infinity);
    const source = sources[k].history;
    const to = Math.min(source.indexAt(end) + 1, source.times.length);
    if (how === "smooth") {
      let smooth = null;
      let before = null;
      within(source, Math.max(source.indexAt(begin - SETTLED * SMOOTHING) - 1, 0), to, (time, value) => {
        smooth = smooth === null ? value : smooth + (value - smooth) * (1 - Math.exp((before - time) / SMOOTHING));
        before = time;
        history.add(time, smooth);
      });
    } else
      within(source, Math.max(source.indexAt(begin) - 1, 0), to, (time, value) => {
        const others = (how === "difference" ? [traces[0]] : traces.slice(1)).map((other) => at(other.history, time));
        if (others.includes(null)) return;
        history.add(time, how === "difference" ? value - others[0] : Math.hypot(value, ...others));
      });
    return { ...trace, history };
  });
}
