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
