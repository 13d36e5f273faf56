// What a plot shows in place of its channels.
import assert from "node:assert/strict";
import test from "node:test";
import { History } from "../../../station/ui/static/lib/history.js";
import { SMOOTHING, transformed } from "../../../station/ui/static/lib/transforms.js";

function trace(label, unit, step, values) {
  const history = new History();
  values.forEach((value, i) => history.add(i * step, value));
  return { label, unit, history };
}

const near = (actual, wanted) => {
  assert.equal(actual.length, wanted.length);
  actual.forEach((value, i) => assert.ok(Math.abs(value - wanted[i]) < 1e-12, `${actual} is not ${wanted}`));
};

test("channels as they are, and a difference or norm of one, are the channels", () => {
  const one = [trace("q1", "rad", 1, [1, 2])];
  for (const how of ["", "difference", "norm"]) assert.equal(transformed(one, how, 0, 9), one);
});

test("a difference is taken at the times of each trace, between the samples of the first", () => {
  const traces = [trace("q1", "rad", 1, [0, 10, 20]), trace("q2", "rad", 0.5, [1, 1, 1, 1, 1, 1])];
  const [shown] = transformed(traces, "difference", 0, 9);
  assert.deepEqual([shown.label, shown.unit], ["q2 − q1", "rad"]);
  near(shown.history.times, [0, 0.5, 1, 1.5, 2]); // the first ends at 2 s
  near(shown.history.values, [1, -4, -9, -14, -19]);
});

test("a norm is the root of the sum of squares", () => {
  const [shown] = transformed([trace("x", "N", 1, [3, 1]), trace("y", "N", 1, [4, 2]), trace("z", "N", 1, [12, -2])], "norm", 0, 9);
  assert.deepEqual([shown.label, shown.unit], ["norm of x, y, z", "N"]);
  near(shown.history.values, [13, 3]);
  const [mixed] = transformed([trace("x", "N", 1, [3]), trace("q", "rad", 1, [4])], "norm", 0, 9);
  assert.equal(mixed.unit, "");
});

test("smoothing answers a step as a first-order lag does, however long the samples are apart", () => {
  for (const step of [0.01, 0.05]) {
    const [shown] = transformed([trace("q", "rad", step, [0, ...Array(100).fill(1)])], "smooth", 0, 9);
    const { times, values } = shown.history;
    near(values, times.map((time) => 1 - Math.exp(-time / SMOOTHING)));
  }
});

test("what is shown does not depend on what came long before", () => {
  const values = Array.from({ length: 400 }, (_, i) => Math.sin(i));
  const whole = transformed([trace("q", "rad", 0.02, values)], "smooth", 0, 9)[0].history;
  const part = transformed([trace("q", "rad", 0.02, values)], "smooth", 6, 9)[0].history;
  assert.ok(Math.abs(whole.nearest(6.5) - part.nearest(6.5)) < 1e-4);
});

test("a spectrum has each sine with its own frequency and amplitude, and no mean", () => {
  const source = new History(Infinity);
  for (let i = 0; i < 3000; i += 1) {
    const time = 100 + i / 300;
    source.add(time, 7 + 2 * Math.sin(2 * Math.PI * 12.34 * time) + 0.05 * Math.cos(2 * Math.PI * 40 * time));
  }
  const [{ history, unit }] = transformed([{ label: "a", unit: "Nm", history: source }], "spectrum", 100, 110);
  assert.equal(unit, "Nm");
  const peak = (from, to) => {
    const first = history.indexAt(from);
    const values = history.values.slice(first, history.indexAt(to));
    const largest = Math.max(...values);
    return [history.times[first + values.indexOf(largest)], largest];
  };
  const near = (found, wanted, part) => assert.ok(Math.abs(found - wanted) < part * wanted, `${found} is not ${wanted}`);
  near(peak(1, 30)[0], 12.34, 0.002);
  near(peak(1, 30)[1], 2, 0.015);
  near(peak(35, 45)[0], 40, 0.002);
  near(peak(35, 45)[1], 0.05, 0.015);
  assert.ok(peak(0, 0.02)[1] < 0.01);
  near(history.times.at(-1), 150, 0.01);
});

test("a spectrum is that of the time that is shown", () => {
  const source = new History(Infinity);
  for (let i = 0; i < 2000; i += 1) source.add(i / 100, Math.sin(2 * Math.PI * (i < 1000 ? 5 : 20) * (i / 100)));
  const at = (begin, end, hz) => transformed([{ label: "a", unit: "", history: source }], "spectrum", begin, end)[0].history.nearest(hz);
  assert.ok(at(0, 10, 5) > 0.98 && at(0, 10, 20) < 0.01);
  assert.ok(at(10, 20, 20) > 0.98 && at(10, 20, 5) < 0.01);
});
