// Numbers and names as people type them.
import assert from "node:assert/strict";
import test from "node:test";
import { commonStart, inDegrees, number, rangeOf, sharedPrefix, shortNames, typed } from "../../../station/ui/static/lib/text.js";

test("a number is read as people type it", () => {
  for (const [text, value] of [["0.3217", 0.3217], [" 18,5 ", 18.5], ["−2", -2], ["1e-3", 1e-3], ["+4", 4]]) assert.equal(typed(text), value);
  for (const text of ["", "  ", "two", "1 2", "1,2,3", "Infinity", "0.1 rad"]) assert.equal(typed(text), null);
});

test("a number is shown with its digits, and no number as a dash", () => {
  assert.equal(number(1.005, 1), "1.0");
  assert.equal(number(-0.0004, 2), "0.00");
  assert.equal(number(-0.4, 1), "-0.4");
  for (const value of [null, undefined, NaN, Infinity]) assert.equal(number(value, 2), "–");
});

test("angles of a sentence are shown in degrees", () => {
  assert.equal(inDegrees("joint1 cannot go to 3 rad; allowed are -2.5 to 2.5 rad."), "joint1 cannot go to 171.89°; allowed are -143.24 to 143.24°.");
  assert.equal(inDegrees("It moves with 1e-1 rad/s."), "It moves with 5.73°/s.");
  for (const other of ["0.3 rad/s or m/s", "0.1 rad or m off", "200 Nm/rad", "0.5 m"]) assert.equal(inDegrees(other), other);
});

test("joints are named by what differs", () => {
  const pandas = ["panda_joint1", "panda_joint2", "panda_finger_joint1"];
  assert.equal(sharedPrefix(pandas), "panda_");
  assert.deepEqual([...shortNames(pandas).values()], ["joint1", "joint2", "finger_joint1"]);
  assert.deepEqual([...shortNames(["elbow_joint", "wrist_1_joint"]).values()], ["elbow", "wrist_1"]);
  assert.equal(sharedPrefix(["alone"]), "");
});

test("texts share what all of them begin with", () => {
  assert.equal(commonStart(["q joint1", "q joint12", "q joint2"]), "q joint");
  for (const texts of [[], ["alone"], ["q", "dq"]]) assert.equal(commonStart(texts), "");
});

test("a range says which of its ends there are", () => {
  assert.equal(rangeOf({ minimum: -1, maximum: 2 }), "-1 to 2");
  assert.equal(rangeOf({ minimum: 0, maximum: null, excludes_minimum: true }), "above 0 to ∞");
  assert.equal(rangeOf({ maximum: 3 }), "−∞ to 3");
  assert.equal(rangeOf({ minimum: null, maximum: null }), "");
});
