// Poses: angles, quaternions and steps.
import assert from "node:assert/strict";
import test from "node:test";
import { anglesOfMatrix, fromAngles, product, stepped, toAngles, turned } from "../../../station/ui/static/lib/pose_maths.js";

const close = (actual, wanted) => actual.forEach((value, i) => assert.ok(Math.abs(value - wanted[i]) < 1e-9, `${actual} is not ${wanted}`));
const QUARTER = Math.PI / 2;
const HALF = Math.SQRT1_2;
const DOWN = [0.3, 0, 0.5, 1, 0, 0, 0]; // turned half about x, as the hand of a Panda

/** The matrix Rz(yaw) Ry(pitch) Rx(roll), written out. */
function matrix([r, p, y]) {
  const [cr, sr, cp, sp, cy, sy] = [r, p, y].flatMap((angle) => [Math.cos(angle), Math.sin(angle)]);
  return [
    [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
    [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
    [-sp, cp * sr, cp * cr],
  ];
}

test("roll, pitch and yaw turn as their matrices do", () => {
  for (const angles of [[0.3, -0.5, 2], [-3, 1.2, -0.1], [Math.PI, 0, 0]])
    for (const vector of [[1, 0, 0], [0, 1, 0], [0.2, -3, 1]]) {
      const wanted = matrix(angles).map((row) => row.reduce((sum, value, i) => sum + value * vector[i], 0));
      close(turned(vector, fromAngles(angles)), wanted);
    }
});

test("angles come back from their quaternion", () => {
  for (const angles of [[0.3, -0.5, 2], [-3, 1.2, -0.1], [0, 0, 0], [1, 1.5, -3]]) close(toAngles(fromAngles(angles)), angles);
});

test("at a pitch of a quarter turn the angles are another name of the same turn", () => {
  for (const pitch of [QUARTER, -QUARTER])
    for (const vector of [[1, 0, 0], [0, 1, 0], [0, 0, 1]]) {
      const quaternion = fromAngles([0.4, pitch, 0.9]);
      close(turned(vector, fromAngles(toAngles(quaternion))), turned(vector, quaternion));
    }
});

test("a step goes along the axes of the base, or of a hand that looks down", () => {
  close(stepped(DOWN, 2, 0.001, false), [0.3, 0, 0.501, 1, 0, 0, 0]);
  close(stepped(DOWN, 2, 0.001, true), [0.3, 0, 0.499, 1, 0, 0, 0]);
  close(stepped(DOWN, 1, 0.001, true), [0.3, -0.001, 0.5, 1, 0, 0, 0]);
  close(stepped(DOWN, 0, -0.001, true), [0.299, 0, 0.5, 1, 0, 0, 0]);
});

test("a step about z turns the other way round for a hand that looks down", () => {
  close(turned([1, 0, 0], stepped(DOWN, 5, QUARTER, false).slice(3)), [0, 1, 0]);
  close(turned([1, 0, 0], stepped(DOWN, 5, QUARTER, true).slice(3)), [0, -1, 0]);
  assert.deepEqual(stepped(DOWN, 5, 0.1, true).slice(0, 3), DOWN.slice(0, 3));
});

test("a full turn of many steps comes back", () => {
  let pose = DOWN;
  for (let i = 0; i < 360; i += 1) pose = stepped(pose, 4, Math.PI / 180, i % 2 === 0);
  for (let i = 0; i < 360; i += 1) pose = stepped(pose, 4, -Math.PI / 180, i % 2 === 1);
  close(turned([1, 2, 3], pose.slice(3)), turned([1, 2, 3], DOWN.slice(3)));
  assert.ok(Math.abs(Math.hypot(...pose.slice(3)) - 1) < 1e-12);
});

test("a product turns first by the second", () => {
  close(turned([1, 0, 0], product([0, 0, HALF, HALF], [0, HALF, 0, HALF])), [0, 0, -1]);
});

test("angles come back from their matrix, in the order of O_T_EE", () => {
  for (const angles of [[0.3, -0.5, 2], [-3, 1.2, -0.1], [0, QUARTER, 0.7]]) {
    const [x, y, z] = [0, 1, 2].map((column) => matrix(angles).map((row) => row[column]));
    close(anglesOfMatrix([...x, 0, ...y, 0, ...z, 0, 0.1, 0.2, 0.3, 1]), angles);
  }
});
