// Samples over time, and what is saved of them.
import assert from "node:assert/strict";
import test from "node:test";
import { History, csvOf } from "../../../station/ui/static/lib/history.js";

const filled = (values, seconds = 60) => {
  const history = new History(seconds);
  values.forEach((value, i) => history.add(i, value));
  return history;
};

test("what is no number, or has the time of the last, is no sample", () => {
  const history = filled([1, null, NaN, 4]);
  history.add(3, 5);
  assert.deepEqual([history.times, history.values], [[0, 3], [1, 4]]);
});

test("a time before the last is that of another run", () => {
  const history = filled([1, 2, 3]);
  history.add(0.5, 9);
  assert.deepEqual([history.times, history.values], [[0.5], [9]]);
});

test("old samples go, and the last seconds stay", () => {
  const history = filled([...Array(200).keys()], 10);
  assert.ok(history.times.length <= 21);
  assert.ok(history.times[0] <= 189);
  assert.equal(history.times.at(-1), 199);
});

test("the sample of a time is the first at or after it, else the last", () => {
  const history = filled([10, 11, 12]);
  assert.deepEqual([-1, 0, 0.5, 2, 7].map((time) => history.valueAt(time)), [10, 10, 11, 12, 12]);
  assert.equal(new History().valueAt(0), undefined);
});

test("the slope of a parabola is exact between its ends", () => {
  const history = filled([0, 1, 4, 9]);
  const { times, values } = history.slopes();
  assert.deepEqual([times, values], [[1, 2], [2, 4]]);
});

test("a copy does not grow with what it is a copy of", () => {
  const history = filled([1, 2]);
  const copy = history.copy();
  history.add(5, 3);
  assert.deepEqual(copy.times, [0, 1]);
});

test("what is shown is saved, a row per sample of the first trace", () => {
  const traces = [
    { label: "q", unit: "rad", history: filled([1, 2, 3, 4]) },
    { label: "τ", unit: "Nm", history: new History() },
  ];
  assert.equal(csvOf(traces, 1, 2), "time [s],q [rad],τ [Nm]\n1,2,\n2,3,\n");
  assert.equal(csvOf([], 0, 1), "time [s]\n");
});

test("the nearest sample may be before a time or after it", () => {
  const history = filled([10, 11, 12]);
  assert.deepEqual([-5, 0.4, 0.6, 1, 9].map((time) => history.nearest(time)), [10, 10, 11, 11, 12]);
  assert.equal(new History().nearest(0), undefined);
});
