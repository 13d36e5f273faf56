import assert from "node:assert/strict";
import test from "node:test";
import { Run, columnOf, linkOf, ofLink, parsed, runOfTrial, tableQuery } from "../../../station/ui/static/lib/recorded.js";

const COLUMNS = [
  "cycle",
  "joint_states/position/panda_joint1",
  "franka_state/panda/tau_ext_hat_filtered/3",
  "franka_state/panda/m_ee",
  "controllers/position/desired/panda_joint1",
  "commands/effort/command/panda_joint1",
];

test("channels of the streams have the columns of a recording that say the same", () => {
  const found = (key) => columnOf(key, COLUMNS);
  assert.equal(found("position/panda_joint1"), COLUMNS[1]);
  assert.equal(found("joint_states|position/@panda_joint1"), COLUMNS[1]);
  assert.equal(found("panda/tau_ext_hat_filtered/3"), COLUMNS[2]);
  assert.equal(found("robot_state/panda|tau_ext_hat_filtered/3"), COLUMNS[2]);
  assert.equal(found("robot_state/panda|m_ee"), COLUMNS[3]);
  assert.equal(found("sample/desired/panda_joint1"), COLUMNS[4]);
  assert.equal(found("controller_state/position|desired/@panda_joint1"), COLUMNS[4]);
  assert.equal(found("recorded|commands/effort/command/panda_joint1"), COLUMNS[5]);
  for (const key of ["loop|lateness/p99", "velocity/panda_joint1", "gripper/panda|width"]) assert.equal(found(key), undefined);
});

const run = (begin, values) => {
  const made = new Run({ kind: "recordings", id: "x", begin, end: begin + 0.3, columns: COLUMNS, events: [{ time: begin + 0.1, until: begin + 0.2, text: "it slipped" }] });
  const rows = values.map((value, i) => `${i},${begin + i / 10},0.1,1,${value}`);
  made.take(parsed(`cycle,time,period,epoch,${COLUMNS[1]}\r\n${rows.join("\r\n")}\r\n`));
  return made;
};

test("a run gives the recorded numbers over the time since its begin", () => {
  const { times, values } = run(2, [0.12345678901234567, "nan", -3, 4]).history("position/panda_joint1");
  assert.deepEqual(values, [0.12345678901234567, -3, 4]);
  times.forEach((time, i) => assert.ok(Math.abs(time - [0, 0.2, 0.3][i]) < 1e-12));
});

test("runs are aligned by a moment of each", () => {
  const [first, second] = [run(0, [0, 0, 5, 0]), run(7, [0, 5, 0, 0])];
  second.align(7.1, first.common(0.2));
  assert.ok(Math.abs(second.history("position/panda_joint1").nearest(0.2) - 5) < 1e-12);
  assert.ok(Math.abs(second.pose(0.2).panda_joint1 - 5) < 1e-12);
  const [mark] = second.marks("B: ");
  assert.equal(mark.text, "B: it slipped");
  assert.ok(Math.abs(mark.at - 0.2) < 1e-9 && Math.abs(mark.until - 0.3) < 1e-9);
});

test("only columns that are not there are read, thinned when there are too many rows", () => {
  const made = run(0, [1, 2, 3, 4]);
  assert.deepEqual(made.missing(["position/panda_joint1", "loop|rate", "robot_state/panda|m_ee"]), [COLUMNS[3]]);
  assert.equal(tableQuery(["a/b", "c"], { duration: 12, cycles: 12000 }).toString(), "channels=a%2Fb&channels=c");
  assert.equal(tableQuery([], { duration: 400, cycles: 400000 }).get("rate"), "50");
});

test("a link says recording, moment, comparison and plots, and is read again", () => {
  const [first, second] = [run(0, []), run(1, [])];
  second.offset = 0.25;
  const link = linkOf([first, second], 1.5, '[{"keys":["position/a"]}]');
  assert.deepEqual(ofLink(`#${link}`), { kind: "recordings", id: "x", time: 1.5, other: { kind: "recordings", id: "x", isOther: true, offset: 0.25 }, layout: '[{"keys":["position/a"]}]' });
  assert.deepEqual(ofLink("#incident=y"), { kind: "incidents", id: "y", time: null, other: null, layout: null });
  assert.equal(ofLink("#docks"), null);
});

test("a trial of an experiment is a run with the numbers of its response", () => {
  const response = { role: "best", joints: ["a", "b"], time: [0, 0.1], position: [[1, 2], [3, 4]], effort: [[5, 6], [7, 8]], desired: [[null, null], [9, 10]] };
  const found = runOfTrial("search:best", response);
  assert.deepEqual(found.history("position/b").values, [2, 4]);
  assert.deepEqual(found.history("effort/a").values, [5, 7]);
  assert.deepEqual(found.history("sample/desired/a").values, [9]);
  assert.deepEqual(found.pose(0.1), { a: 3, b: 4 });
  assert.deepEqual(found.missing(["position/a", "velocity/a"]), []);
  const { kind, id } = ofLink(linkOf([found], 0.05, ""));
  assert.deepEqual([kind, id], ["experiments", "search:best"]);
});
