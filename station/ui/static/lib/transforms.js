// What a plot may show in place of its channels; needs no page.
import { History } from "./history.js";

/** Time constant of smoothing [s]: faster than 1.6 Hz is damped. */
export const SMOOTHING = 0.1;
const SETTLED = 10; // time constants after which the first sample is forgotten

/** The transforms by what they are called in a saved plot. */
export const TRANSFORMS = { "": "channels as they are", smooth: "smoothed", difference: "minus the first", norm: "norm of all" };

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
