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

/** Return the value of a channel at a time, straight between two of its samples; null beyond them. */
function at({ history }, time) {
  const { times, values } = history;
  const after = history.indexAt(time);
  if (times[after] === time) return values[after];
  if (after === 0 || after >= times.length) return null;
  const part = (time - times[after - 1]) / (times[after] - times[after - 1]);
  return values[after - 1] + part * (values[after] - values[after - 1]);
}

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
function spectrum(trace, begin, end) {
  const made = new History(Infinity);
  const source = trace.history;
  const from = source.indexAt(begin);
  const count = source.indexAt(end) - from;
  if (count < 8) return made;
  const [first, last] = [source.times[from], source.times[from + count - 1]];
  const period = (last - first) / (count - 1);
  // Streams have samples at almost even times; a recording has them at even ones.
  const values = Array.from({ length: count }, (_, i) => at(trace, Math.min(first + i * period, last)));
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

/** Return samples that `take(time, value)` makes of those from `begin` to `end` [s] and of one on each side. */
function made(source, begin, end, take) {
  const history = new History(Infinity);
  const { times, values } = source.history;
  const to = Math.min(source.history.indexAt(end) + 1, times.length);
  for (let i = Math.max(source.history.indexAt(begin) - 1, 0); i < to; i += 1) history.add(times[i], take(times[i], values[i]));
  return history;
}

function smoothed(source, begin, end) {
  let [smooth, before] = [null, null];
  return made(source, begin - SETTLED * SMOOTHING, end, (time, value) => {
    smooth = smooth === null ? value : smooth + (value - smooth) * (1 - Math.exp((before - time) / SMOOTHING));
    before = time;
    return smooth;
  });
}

/** Return what `take` makes of the values of channels, at the times of the first at which all of them have one. */
function combined([source, ...others], begin, end, take) {
  return made(source, begin, end, (time, value) => {
    const values = others.map((other) => at(other, time));
    return values.includes(null) ? null : take(value, ...values);
  });
}

/**
 * Return the traces {label, unit, history} that are shown from `begin` to `end` [s]. A
 * difference or norm has a sample where all its channels have one, or lie between two.
 */
export function transformed(traces, how, begin, end) {
  if (how === SPECTRUM) return traces.map((trace) => ({ ...trace, history: spectrum(trace, begin, end) }));
  if (how === "smooth") return traces.map((trace) => ({ ...trace, label: `smoothed ${trace.label}`, history: smoothed(trace, begin, end) }));
  const [first, ...others] = traces;
  if (!["difference", "norm"].includes(how) || !others.length) return traces;
  const isOneUnit = ({ unit }) => unit === first.unit;
  if (how === "difference")
    return others.map((one) => ({ ...one, label: `${one.label} − ${first.label}`, unit: isOneUnit(one) ? one.unit : "", history: combined([one, first], begin, end, (a, b) => a - b) }));
  const label = `norm of ${traces.map((trace) => trace.label).join(", ")}`;
  return [{ ...first, label, unit: others.every(isOneUnit) ? first.unit : "", history: combined(traces, begin, end, Math.hypot) }];
}
