// What a gamepad's sticks and buttons ask for.
import assert from "node:assert/strict";
import test from "node:test";
import { directionsOf } from "../../../station/ui/static/lib/gamepad_map.js";

const pad = (axes, ...pressed) => ({ axes, buttons: Array.from({ length: 17 }, (_, i) => ({ pressed: pressed.includes(i) })) });

test("a stick at rest, which is never quite at zero, moves nothing", () => {
  assert.deepEqual(directionsOf(pad([0.1, -0.11, 0.05, 0.02])), [0, 0, 0, 0, 0, 0]);
});

test("a full deflection is one, and forwards, left and up are positive", () => {
  assert.deepEqual(directionsOf(pad([-1, -1, -1, -1])), [1, 1, 1, 0, 0, 1]);
  assert.deepEqual(directionsOf(pad([1, 1, 1, 1])), [-1, -1, -1, 0, 0, -1]);
});

test("half of the way beyond the dead zone asks for a quarter of the speed", () => {
  assert.ok(Math.abs(directionsOf(pad([0, -0.56, 0, 0]))[0] - 0.25) < 1e-12);
});

test("the cross turns about x and y, and its two ways cancel", () => {
  assert.deepEqual(directionsOf(pad([0, 0, 0, 0], 15, 12)).slice(3), [1, 1, 0]);
  assert.deepEqual(directionsOf(pad([0, 0, 0, 0], 14, 13)).slice(3), [-1, -1, 0]);
  assert.deepEqual(directionsOf(pad([0, 0, 0, 0], 14, 15)).slice(3), [0, 0, 0]);
});
