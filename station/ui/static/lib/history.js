// Samples over time, and what is saved of them; needs no page.

/** The samples of a channel of the last minute. */
export class History {
  constructor(seconds = 60) {
    this.seconds = seconds;
    this.times = [];
    this.values = [];
  }

  add(time, value) {
    const last = this.times.at(-1);
    if (last !== undefined && time < last) this.clear(); // the station has restarted
    if (time === last || value == null || !Number.isFinite(value)) return;
    this.times.push(time);
    this.values.push(value);
    if (this.times[0] < time - 2 * this.seconds) {
      const first = this.indexAt(time - this.seconds);
      this.times.splice(0, first);
      this.values.splice(0, first);
    }
  }

  /** Return the rates of change, each over the neighbours of a sample; the ends have none. */
  slopes() {
    const made = new History(Infinity);
    for (let i = 1; i < this.times.length - 1; i += 1) made.add(this.times[i], (this.values[i + 1] - this.values[i - 1]) / (this.times[i + 1] - this.times[i - 1]));
    return made;
  }

  /** Return the same samples, to which nothing is added. */
  copy() {
    return Object.assign(new History(this.seconds), { times: [...this.times], values: [...this.values] });
  }

  clear() {
    this.times.length = this.values.length = 0;
  }

  /** Return the value of the first sample at or after a time, or the last; undefined without samples. */
  valueAt(time) {
    return this.values[Math.min(this.indexAt(time), this.values.length - 1)];
  }

  /** Return the value of the sample whose time is nearest; undefined without samples. */
  nearest(time) {
    const after = Math.min(this.indexAt(time), this.times.length - 1);
    return this.values[after > 0 && time - this.times[after - 1] < this.times[after] - time ? after - 1 : after];
  }

  /** Return the index of the first sample at or after a time. */
  indexAt(time) {
    let low = 0;
    let high = this.times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

/** Return traces {label, unit, history} as CSV, one row per sample of the first from `begin` to `end` [s]. */
export function csvOf(traces, begin, end, over = "time [s]") {
  const lines = [[over, ...traces.map((trace) => `${trace.label} [${trace.unit}]`)].join(",")];
  const first = traces[0]?.history;
  for (let i = first?.indexAt(begin) ?? 0; first && i < first.times.length && first.times[i] <= end; i += 1) {
    const time = first.times[i];
    const at = ({ history, scale = 1 }) => history.valueAt(time) * scale;
    lines.push([time, ...traces.map((trace) => (trace.history.times.length ? at(trace) : ""))].join(","));
  }
  return `${lines.join("\n")}\n`;
}
