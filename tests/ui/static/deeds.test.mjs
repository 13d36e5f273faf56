// The words for what the station's events say.
import assert from "node:assert/strict";
import test from "node:test";
import { deedOf } from "../../../station/ui/static/lib/deeds.js";

const request = (what, result = "200", text = `${what} of ada was carried out.`) => deedOf({ kind: "request", what, result, text });

test("a request is told by what it did", () => {
  assert.equal(request("POST /stop/release"), "released the stop, or allowed motion.");
  assert.equal(request("PATCH /controllers/arm/gains"), "changed gains of arm.");
  assert.equal(request("POST /gain-sets/undo"), "took back the last change of gains.");
  assert.equal(request("PUT /robots/panda/ee_frame"), "set ee_frame of panda.");
  assert.equal(request("POST /robots/panda/gripper/grasp"), "commanded the gripper of panda to grasp.");
  assert.equal(request("POST /robots/error_recovery"), "recovered the robot.");
  assert.equal(request("DELETE /control"), "gave back control.");
  assert.equal(request("POST /robots/left/error_recovery"), "recovered the robot.");
});

test("a refused request is told by what it did not do, and why", () => {
  assert.equal(request("DELETE /controllers/arm", "409 controller_state"), "could not unload arm (409 controller_state).");
});

test("repeats keep their number", () => {
  const text = "15 more times within 10 s: PUT /controllers/jog/command of ada was carried out.";
  assert.equal(request("PUT /controllers/jog/command", "200", text), "15 more times within 10 s: commanded jog.");
});

test("other events, and requests that nobody has words for, keep the station's words", () => {
  assert.equal(deedOf({ kind: "stop", what: "", result: "armed", text: "The station was armed." }), "The station was armed.");
  assert.equal(request("POST /new/thing"), "POST /new/thing of ada was carried out.");
  assert.equal(deedOf({ kind: "mode", what: "panda", result: "idle", text: "" }), "mode panda idle");
});
