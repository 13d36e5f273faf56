// Channels: the numbers in a frame, and what they are called.
import assert from "node:assert/strict";
import test from "node:test";
import { described, numberAt, numbersIn } from "../../../station/ui/static/lib/channel_maths.js";

const FRAME = { name: ["j1", "j2"], position: [0.1, 0.2], loop: { rate: 1000 }, objects: [{ name: "cube", mass: 0.1 }], on: true, text: "x" };

test("every number has a path, by the names beside it", () => {
  assert.deepEqual(numbersIn(FRAME), ["position/@j1", "position/@j2", "loop/rate", "objects/@cube/mass", "on"]);
});

test("a quantity that has no value yet has a path, too", () => {
  assert.deepEqual(numbersIn({ loop: { total: { p99: null, count: 0 } }, fault: null }), ["loop/total/p99", "loop/total/count"]);
});

test("a path leads to its number wherever it stands in the list", () => {
  const turned = { ...FRAME, name: ["j2", "j1"] };
  assert.equal(numberAt(turned, "position/@j1"), 0.2);
  assert.equal(numberAt(FRAME, "objects/@cube/mass"), 0.1);
  assert.equal(numberAt(FRAME, "on"), 1);
  for (const path of ["text", "position/@j9", "loop/none/deep", "objects/@ball/mass"]) assert.equal(numberAt(FRAME, path), undefined);
});

test("a key says what it is, with its unit", () => {
  assert.deepEqual(described("robot_state/panda|tau_J_d/3"), { label: "panda tau_J_d [3]", unit: "Nm" });
  assert.equal(described("robot_state/panda|O_F_ext_hat_K/2").unit, "N");
  assert.equal(described("robot_state/panda|O_F_ext_hat_K/3").unit, "Nm");
  assert.equal(described("loop|loop/lateness/p99").unit, "s");
});
