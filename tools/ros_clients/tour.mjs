// Drive a station by an unmodified roslib: what docs/ros_tools.md says of it.
//
// By hand, in a folder of its own with a copy of this file (npm install roslib@2.1.0),
// against `station run --rosbridge`:
//
//   node tour.mjs ws://127.0.0.1:9090/?token=TOKEN
//
// In a browser: npx esbuild tour.mjs --bundle --format=esm --outfile=tour.js, then serve a
// page with <script type="module" src="tour.js"> from an origin that the station allows
// (`rosbridge.allowed_origins`), and open it at `?url=ws://…` with the token in it encoded.
import * as ROSLIB from "roslib";

const JOINTS = [1, 2, 3, 4, 5, 6, 7].map((number) => `panda_joint${number}`);
const ARM = "effort_joint_trajectory_controller";
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
const ros = new ROSLIB.Ros({});
await ros.connect(globalThis.process?.argv[2] ?? new URLSearchParams(location.search).get("url"));
const call = (name, serviceType, request = {}) =>
  new Promise((done, failed) =>
    new ROSLIB.Service({ ros, name, serviceType }).callService(request, done, failed));

console.log(await new Promise((done, failed) => ros.getTopics((t) => done(t.topics.length), failed)), "topics");
const toured = { type: "position_controllers/JointGroupPositionController", joints: JOINTS };
await new Promise((done) => new ROSLIB.Param({ ros, name: "/toured" }).set(toured, done));
for (const verb of ["load", "unload"])
  console.log(verb, await call(`/controller_manager/${verb}_controller`, `controller_manager_msgs/${verb === "load" ? "Load" : "Unload"}Controller`, { name: "toured" }));
console.log((await call("/controller_manager/list_controllers", "controller_manager_msgs/ListControllers")).controller.length, "controllers");
console.log("switch", await call("/controller_manager/switch_controller", "controller_manager_msgs/SwitchController",
  { start_controllers: [ARM], stop_controllers: [], strictness: 2 }));
let last;
for (const compression of ["none", "png", "cbor", "cbor-raw"]) {
  for (const messageType of ["sensor_msgs/JointState", "sensor_msgs/msg/JointState"]) {
    const topic = new ROSLIB.Topic({ ros, name: "/joint_states", messageType, compression });
    let count = 0;
    topic.subscribe((message) => { count += 1; last = message.position ? message : last; });
    await sleep(1000);
    topic.unsubscribe();
    console.log(compression, messageType, count, "in a second", JSON.stringify(last.header.stamp));
  }
}
const goal = [...last.position].slice(0, 7);
goal[0] += 0.15;
const server = `/${ARM}/follow_joint_trajectory`;
const actionClient = new ROSLIB.ActionClient({ ros, serverName: server, actionName: "control_msgs/FollowJointTrajectoryAction" });
const followed = new ROSLIB.Goal({ actionClient, goalMessage: { trajectory: {
  joint_names: JOINTS, points: [{ positions: goal, time_from_start: { secs: 1, nsecs: 5e8 } }] } } });
let feedback = 0;
followed.on("feedback", () => { feedback += 1; });
const ended = new Promise((done) => followed.on("result", done));
followed.send();
console.log("actionlib", await ended, feedback, "times feedback");
goal[0] -= 0.15;
const action = new ROSLIB.Action({ ros, name: server, actionType: "control_msgs/action/FollowJointTrajectory" });
console.log("ROS 2", await new Promise((done, failed) => action.sendGoal({ trajectory: {
  joint_names: JOINTS, points: [{ positions: goal, time_from_start: { sec: 1, nanosec: 0 } }] } }, done, () => {}, failed)));
console.log(JSON.stringify(await call(`/${ARM}/gains/panda_joint2/set_parameters`, "dynamic_reconfigure/Reconfigure",
  { config: { doubles: [{ name: "p", value: 550 }] } })));
console.log(await call("/stop", "std_srvs/Trigger"), await call("/stop/release", "std_srvs/Trigger"), await call("/stop/arm", "std_srvs/Trigger"));
console.log("done");
globalThis.process?.exit(0);
