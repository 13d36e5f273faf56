// Waypoints and moves: capture, edit, order and play; the hand; what Franka Desk sets.
import { h, holdButton, kept, number, show, sharedPrefix, typed } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { refusals } from "../lib/refusals.js";
import { act, api, desk } from "../lib/station.js";
import { store, switchTo } from "../lib/store.js";

const LOOK_MS = 250;
const FINAL = new Set(["succeeded", "aborted", "preempted"]);
const AXES = ["x", "y", "z", "about x", "about y", "about z"];
const AT_MOST = 1.0; // speed of a played path [rad/s]: shorter times are refused here

class Move extends Panel {
  build() {
    this.points = kept.get("waypoints", []);
    this.list = h("ol", { class: "waypoints" });
    const button = (label, title, run, primary) => h("button", { class: primary ? "s primary" : "s", type: "button", title, onclick: run }, label);
    this.playButton = button("▶ Play", "Move through all waypoints in order", () => this.play(this.points), true);
    this.cancelButton = button("Cancel", "End the motion; the joints hold where they are", () => this.cancel());
    this.cancelButton.disabled = true;
    this.loop = button("Loop", "Begin again at the end", () => {
      this.looping = !this.looping;
      this.loop.setAttribute("aria-pressed", String(this.looping));
    });
    this.progress = h("progress", { max: 1, value: 0, hidden: true });
    this.state = h("p", { class: "hint state" }, "Capture where the arm is, move it, capture again, then Play.");
    this.append(
      h("div", { class: "line" }, button("+ Capture", "Keep the present joints as the next waypoint", () => this.capture()), this.playButton, this.loop, this.cancelButton, this.progress),
      this.list,
      this.state,
      this.buildHand(),
      this.buildArm(),
    );
    this.drawList();
    this.watch();
  }

  get joints() {
    return store.docks?.joints ?? [];
  }

  capture() {
    if (!store.joints) return;
    const positions = {};
    for (const joint of this.joints) positions[joint] = store.joints.position[store.joints.name.indexOf(joint)];
    const number = 1 + Math.max(0, ...this.points.map((p) => Number(/^point (\d+)$/.exec(p.name)?.[1] ?? 0)));
    this.points.push({ name: `point ${number}`, seconds: 2, positions });
    this.keep();
  }

  keep() {
    kept.set("waypoints", this.points);
    this.drawList();
  }

  drawList() {
    const prefix = sharedPrefix(this.joints);
    this.list.replaceChildren(
      ...this.points.map((point, i) => {
        const button = (label, title, run, disabled = false) => {
          const made = h("button", { class: "s", type: "button", title, onclick: run, disabled }, label);
          made.setAttribute("aria-label", `${title}: ${point.name}`);
          return made;
        };
        const name = h("input", { class: "name", value: point.name });
        name.setAttribute("aria-label", `Name of waypoint ${i + 1}`);
        name.addEventListener("change", () => {
          point.name = name.value;
          kept.set("waypoints", this.points);
        });
        const seconds = h("input", { class: "value", value: String(point.seconds), inputMode: "decimal" });
        seconds.setAttribute("aria-label", `Seconds to ${point.name}`);
        seconds.addEventListener("change", () => {
          const value = typed(seconds.value);
          if (value !== null && value > 0) point.seconds = value;
          seconds.value = String(point.seconds);
          kept.set("waypoints", this.points);
        });
        const title = Object.entries(point.positions).map(([joint, q]) => `${joint.slice(prefix.length)}: ${number(q, 4)}`).join("\n");
        const swap = (j) => () => {
          [this.points[i], this.points[j]] = [this.points[j], this.points[i]];
          this.keep();
        };
        return h(
          "li",
          { title },
          name,
          seconds,
          " s ",
          button("Go", "Move to this waypoint", () => this.play([point])),
          button("Set", "Replace by where the arm is now", () => {
            for (const joint of this.joints) point.positions[joint] = store.joints.position[store.joints.name.indexOf(joint)];
            this.keep();
          }),
          button("↑", "Move up", swap(i - 1), i === 0),
          button("↓", "Move down", swap(i + 1), i === this.points.length - 1),
          button("✕", "Remove", () => {
            this.points.splice(i, 1);
            this.keep();
          }),
        );
      }),
    );
  }

  /** Return a trajectory controller for all joints of the waypoints; prefer one that runs. */
  chooseController() {
    const fits = store.docks.controllers.filter((c) => c.type.endsWith("JointTrajectoryController"));
    return fits.find((c) => c.state === "running") ?? fits.find((c) => c.state !== "loading");
  }

  async play(points) {
    if (!points.length) return show(this.state, "There is no waypoint yet: Capture where the arm is.");
    const controller = this.chooseController();
    if (!controller) {
      refusals.add({ code: "no_controller", detail: "No trajectory controller is loaded.", remedy: "Load a JointTrajectoryController in the dock Controllers." });
      return;
    }
    const joints = controller.resources;
    const here = joints.map((joint) => store.joints.position[store.joints.name.indexOf(joint)]);
    let before = here;
    let time = 0;
    const trajectory = { joint_names: joints, points: [] };
    for (const point of points) {
      const positions = joints.map((joint, i) => point.positions[joint] ?? before[i]);
      const farthest = Math.max(...positions.map((q, i) => Math.abs(q - before[i])));
      if (farthest / point.seconds > AT_MOST) {
        refusals.add({ code: "too_fast", detail: `The way to “${point.name}” is ${number(farthest, 2)} rad in ${point.seconds} s.`, remedy: `Give it at least ${number(farthest / AT_MOST + 0.05, 1)} s.` });
        return;
      }
      time += point.seconds;
      trajectory.points.push({ positions, time_from_start: time });
      before = positions;
    }
    if (controller.state !== "running" && !(await switchTo(controller.name))) return;
    const goal = await act("POST", `/controllers/${controller.name}/goals`, { goal: { trajectory } });
    if (!goal) return;
    this.goal = { controller: controller.name, id: goal.id, seconds: time, points };
  }

  async cancel() {
    if (!this.goal) return;
    this.looping = false;
    this.loop.setAttribute("aria-pressed", "false");
    await act("DELETE", `/controllers/${this.goal.controller}/goals/${this.goal.id}`);
  }

  async watch() {
    if (this.goal) await this.look();
    setTimeout(() => this.watch(), LOOK_MS);
  }

  async look() {
    let goal;
    try {
      goal = await api("GET", `/controllers/${this.goal.controller}/goals/${this.goal.id}`);
    } catch {
      return; // The strip says when the station is lost.
    }
    const over = FINAL.has(goal.status);
    this.progress.hidden = over;
    this.progress.value = goal.progress;
    this.cancelButton.disabled = over;
    const left = (1 - goal.progress) * this.goal.seconds;
    const end = goal.result?.message ? `: ${goal.result.message}` : ".";
    show(this.state, over ? `The motion ${goal.status}${end}` : `${number(goal.progress * 100, 0)} % · ${number(left, 1)} s left · ${this.goal.controller}`);
    if (!over) return;
    const { points } = this.goal;
    this.goal = null;
    if (goal.status === "succeeded" && this.looping) this.play(points);
  }

  buildHand() {
    this.handState = h("p", { class: "hint" });
    this.startJog = h("button", { class: "s", type: "button" }, "Start hand jog");
    this.startJog.addEventListener("click", () => this.startKind("CartesianJogController"));
    this.startTarget = h("button", { class: "s", type: "button" }, "Start hand targets");
    this.startTarget.addEventListener("click", () => this.startKind("CartesianStreamingController"));
    this.handButtons = AXES.flatMap((axis, i) =>
      [-1, 1].map((sign) =>
        holdButton(`${sign < 0 ? "−" : "+"} ${axis}`, `Move the hand ${sign < 0 ? "against" : "along"} ${axis} while held`, () => desk.say({ do: "hand", axis: i, sign }), () => desk.say({ do: "release" })),
      ),
    );
    this.targets = ["x", "y", "z"].map((axis) => {
      const input = h("input", { class: "value", inputMode: "decimal" });
      input.setAttribute("aria-label", `Hand ${axis} [m]`);
      return input;
    });
    this.reach = h("button", { class: "s", type: "button", title: "Move the hand there; it keeps its orientation" }, "Go there");
    this.reach.addEventListener("click", () => {
      const position = this.targets.map((input) => typed(input.value));
      if (position.includes(null)) refusals.add({ code: "not_a_number", detail: "Type x, y and z in metres." });
      else desk.say({ do: "reach", position });
    });
    const here = h("button", { class: "s", type: "button", title: "Fill in where the hand is" }, "Here");
    here.addEventListener("click", () => {
      const pose = Object.values(store.arms)[0]?.O_T_EE;
      if (pose) this.targets.forEach((input, i) => (input.value = number(pose[12 + i], 4)));
    });
    desk.addEventListener("change", () => this.isShown && this.showHand());
    const fields = this.targets.map((input, i) => h("label", {}, `${AXES[i]} `, input));
    return h(
      "details",
      { class: "hand" },
      h("summary", {}, "Hand: jog and target"),
      this.handState,
      h("div", { class: "line" }, this.startJog, this.startTarget),
      h("div", { class: "jog" }, ...this.handButtons),
      h("div", { class: "line" }, ...fields, " m", here, this.reach),
    );
  }

  startKind(kind) {
    const controller = store.docks.controllers.find((c) => c.type.endsWith(kind));
    if (controller) switchTo(controller.name);
    else refusals.add({ code: "no_controller", detail: `No ${kind} is loaded.`, remedy: "Load one in the dock Controllers." });
  }

  showHand() {
    const { jog, target } = desk.state;
    if (!jog) return;
    for (const button of this.handButtons) button.disabled = Boolean(jog.reason) || !jog.controller;
    this.reach.disabled = Boolean(target.reason) || !target.controller;
    this.startJog.hidden = Boolean(jog.controller) || !store.isOperator;
    this.startTarget.hidden = Boolean(target.controller) || !store.isOperator;
    const text = jog.controller && !jog.reason ? `Hold a button: ${jog.controller} moves the hand in the axes of the base.` : target.controller && !target.reason ? `${target.controller} goes to a typed or dragged target.` : "Start one of the two: a jog while a button is held, or targets that the hand goes to.";
    show(this.handState, text);
  }

  buildArm() {
    this.arm = h("select", {});
    this.arm.setAttribute("aria-label", "Arm");
    const group = (title, fields, run) => {
      const inputs = fields.map(([label, value, unit]) => {
        const input = h("input", { class: "value wide", value });
        input.setAttribute("aria-label", `${title}: ${label}`);
        return { input, row: h("label", {}, `${label} `, input, ` ${unit}`) };
      });
      const set = h("button", { class: "s", type: "button" }, "Set");
      set.setAttribute("aria-label", `Set ${title}`);
      set.addEventListener("click", () => {
        const values = inputs.map(({ input }) => input.value.split(/[,\s]+/).filter(Boolean).map(Number));
        if (values.some((list) => !list.length || list.some(Number.isNaN))) refusals.add({ code: "not_a_number", detail: `${title}: type numbers, separated by commas.` });
        else run(values);
      });
      return h("div", { class: "group" }, h("b", {}, title), ...inputs.map(({ row }) => row), set);
    };
    const put = async (route, body) => {
      if (await act("PUT", `/robots/${this.arm.value}/${route}`, body)) show(this.armState, `Set: ${route.replaceAll("_", " ")}.`);
    };
    this.armState = h("p", { class: "hint" }, "Refused while the arm moves. Vectors are typed with commas; one number fills all.");
    const all = (list, n) => (list.length === 1 ? Array(n).fill(list[0]) : list);
    const guide = h("button", { class: "s", type: "button", title: "Press the guiding buttons, so that the arm can be pushed by hand; simulation only" }, "Guiding on");
    guide.addEventListener("click", async () => {
      const pressed = guide.textContent === "Guiding on";
      if (await act("POST", `/robots/${this.arm.value}/guiding`, { pressed })) show(guide, pressed ? "Guiding off" : "Guiding on");
    });
    return h(
      "details",
      { class: "arm" },
      h("summary", {}, "Arm: collision thresholds, load, end effector"),
      this.armState,
      h("div", { class: "line" }, this.arm, guide),
      group("Collision thresholds", [["contact torque", "20, 20, 18, 18, 16, 14, 12", "Nm"], ["collision torque", "40, 40, 36, 36, 32, 28, 24", "Nm"], ["contact force", "20, 20, 20, 25, 25, 25", "N, Nm"], ["collision force", "40, 40, 40, 50, 50, 50", "N, Nm"]], ([a, b, c, d]) =>
        put("force_torque_collision_behavior", { lower_torque_thresholds_nominal: all(a, 7), upper_torque_thresholds_nominal: all(b, 7), lower_force_thresholds_nominal: all(c, 6), upper_force_thresholds_nominal: all(d, 6) })),
      group("Load", [["mass", "0.2", "kg"], ["centre in the flange", "0, 0, 0.1", "m"], ["inertia xx, yy, zz", "0.001, 0.001, 0.001", "kg m²"]], ([mass, centre, [x, y, z]]) =>
        put("load", { mass: mass[0], F_x_center_load: centre, load_inertia: [x, 0, 0, 0, y, 0, 0, 0, z] })),
      group("End effector in the nominal frame", [["x, y, z", "0, 0, 0", "m"]], ([[x, y, z]]) => put("ee_frame", { NE_T_EE: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1] })),
    );
  }

  refresh() {
    const arms = store.docks.arms.map((arm) => arm.arm_id);
    if (arms.join() !== this.arms) {
      this.arms = arms.join();
      this.arm.replaceChildren(...arms.map((name) => h("option", {}, name)));
      this.querySelector(".arm").hidden = this.querySelector(".hand").hidden = !arms.length;
    }
    this.playButton.disabled = !store.isOperator;
    this.showHand();
  }
}

customElements.define("st-move", Move);
