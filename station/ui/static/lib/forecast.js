// What a motion would do, tried in a copy of the station or with a model of a real arm: the verdict in words, the way as a ghost.
import { act, button, h, line, number, store, switchTo, units } from "./panel.js";
import { hideGhost, showGhost, ticking } from "./ghost.js";

const PEAK = 1.875; // peak over mean speed of a motion from rest to rest
const SHORTEST_S = 0.5;
const TRAJECTORY = /\/JointTrajectoryController$/;

/** Return the step of a rehearsal that is a request of the API; null when it moves nothing. */
export function stepOf({ operation, target, request }) {
  const body = request ?? {};
  const steps = {
    put_command: () => ({ kind: "set_point", name: target, values: body.command ?? [] }),
    submit_goal: () => ({ kind: "goal", name: target, request: body.goal ?? {} }),
    follow_trajectory: () => ({ kind: "trajectory", name: target, request: body }),
    play_waypoint_path: () => ({ kind: "path", path: target, options: { ...body, loop: false } }),
    switch_controllers: () => ({ kind: "switch", start: body.start ?? [], stop: body.stop ?? [] }),
    patch_gains: () => ({ kind: "gains", changes: { [target]: body.values ?? {} } }),
  };
  return steps[operation]?.() ?? null;
}

/** Return the verdict of a rehearsal and what else is good to know, as sentences. */
export function wordsOf({ outcome, error, duration, joints, contacts, twin }) {
  const angle = (value) => `${number(value * units.scale, units.angle === "deg" ? 1 : 3)}${units.sign}`;
  const least = (key) => joints.filter((one) => one[key] != null).sort((a, b) => a[key] - b[key])[0];
  const verdict = {
    completed: `It would be completed in ${number(duration, 2)} s.`,
    refused: `The station would refuse it. ${error?.text}`,
    failed: `It would end after ${number(error?.time, 2)} s${error?.where ? `, at ${error.where}` : ""}. ${error?.text}`,
    unfinished: `It would not be over after ${number(duration, 1)} s.`,
  }[outcome];
  const [range, speed, torque] = ["position_margin", "velocity_margin", "effort_margin"].map(least);
  const part = (one, key, what) => one && `${number(one[key] * 100, 0)} % of the ${what} of ${one.joint}`;
  const left = [range && `${store.docks?.sliding.includes(range.joint) ? `${number(range.position_margin, 3)} m` : angle(range.position_margin)} to the end of ${range.joint}`, part(speed, "velocity_margin", "speed"), part(torque, "effort_margin", "torque")].filter(Boolean);
  const touched = contacts.length ? `Touches ${contacts.slice(0, 3).map(({ bodies, force }) => `${bodies.join(" and ")} with ${number(force, 0)} N`).join(", ")}.` : "Touches nothing.";
  const worth = twin === "model" ? "A model of the arm was moved; it is as good as its parameters." : "";
  return [units.words(verdict), left.length ? `Left: ${left.join(", ")}.` : "", touched, worth].filter(Boolean).join(" ");
}

/** A card with the forecast of one motion at a time. */
export class Forecast {
  element = h("div", { class: "forecast", role: "status", hidden: true });
  asked = 0;
  stopPlaying = () => {};

  /** Try steps; a motion that would be completed can be made as it was rehearsed, unless it `isOfOther`. */
  async rehearse(steps, { isOfOther = false, before = "" } = {}) {
    const answer = await this.ask("Trying it …", "/rehearse", { steps, certificate: !isOfOther });
    if (!answer) return;
    const name = answer.certificate?.name;
    const move = name ? button("Move as rehearsed", "The robot moves like the ghost, and stops if it leaves that way.", () => this.carryOut(steps, name), { class: "s primary" }) : null;
    this.show(`${before}${wordsOf(answer)}`, answer.outcome === "completed", [move, button("Play again", "Let the ghost move once more; the robot does not.", () => this.play(answer))]);
    // Who asked for less motion sees where it ends, and plays it by a click.
    this.play(answer, matchMedia("(prefers-reduced-motion: reduce)").matches);
  }

  /** Try a motion of the joints to positions, straight and at most at a speed [rad/s]. */
  async rehearseMove(targets, speed) {
    const controller = controllerFor(targets);
    if (!controller) return this.show(WITHOUT_CONTROLLER, false);
    const joints = controller.resources;
    const now = store.positionsOf(joints);
    const positions = joints.map((joint, i) => targets[joint] ?? now[i]);
    const time = Math.max(SHORTEST_S, ...positions.map((q, i) => (PEAK * Math.abs(q - now[i])) / speed));
    const rest = joints.map(() => 0);
    const point = { positions, velocities: rest, accelerations: rest, time_from_start: time };
    const goal = { kind: "goal", name: controller.name, request: { trajectory: { joint_names: joints, points: [point] } } };
    return this.rehearse([...startOf(controller), goal]);
  }

  /** Try one round of a waypoint path. */
  rehearsePath({ name, waypoints }, options) {
    const controller = controllerFor(waypoints[0].positions);
    return this.rehearse([...(controller ? startOf(controller) : []), { kind: "path", path: name, options }]);
  }

  /** Search for a way around what is in the way, to positions of joints or to the pose of their hand, and try it. */
  async goAround(targets, pose = null) {
    const found = await this.plan(targets, pose);
    if (!found) return undefined;
    const { controller, plan } = found;
    const way = plan.direct ? "The straight way is free. " : `A way around with ${plan.positions.length - 2} corners. `;
    return this.rehearse([{ kind: "goal", name: controller.name, request: plan.goal }], { before: way });
  }

  /** Try to move joints straight to where their hand has a pose, at most at a speed [rad/s]. */
  async rehearseHand(targets, pose, speed) {
    const found = await this.plan(targets, pose);
    if (!found) return undefined;
    const ends = found.plan.positions.at(-1);
    return this.rehearseMove(Object.fromEntries(found.plan.joints.map((joint, i) => [joint, ends[i]])), speed);
  }

  /** Search for a way; starts a controller of trajectories if none runs. */
  async plan(targets, pose) {
    const controller = controllerFor(targets);
    if (!controller) return this.show(WITHOUT_CONTROLLER, false);
    if (controller.state !== "running" && !(await switchTo(controller.name))) return undefined;
    const plan = await this.ask("Searching for a way …", "/plan", { controller: controller.name, ...(pose ? { pose } : { positions: targets }) });
    return plan && { controller, plan };
  }

  /** Return the buttons that try a motion before it is made; they do nothing while `off()`. */
  trials(rehearse, goAround, off) {
    return [
      button("Rehearse", "Try the motion in a copy of the station: how it would end, and a ghost of it. Nothing moves.", rehearse, { needs: "change", off }),
      button("Go around", "Search for a way that touches nothing, try it, and show its ghost. Starts a trajectory controller if none runs; nothing moves yet.", goAround, { needs: "change", off }),
    ];
  }

  async ask(text, path, body) {
    const asked = (this.asked += 1);
    this.show(text, true);
    const answer = await act("POST", path, body);
    if (asked !== this.asked) return null; // another motion was asked for meanwhile
    if (!answer) this.close();
    return answer;
  }

  show(text, isGood, buttons = []) {
    this.stopPlaying();
    this.element.hidden = false;
    this.element.classList.toggle("fault", !isGood);
    const leave = button("Leave it", "Hide the forecast and its ghost.", () => this.close());
    this.element.replaceChildren(h("p", {}, `${isGood ? "" : "✖ "}${text}`), line(...buttons.filter(Boolean), leave));
    this.element.scrollIntoView({ block: "nearest" });
  }

  /** Let the ghost go the way that was rehearsed, in its own time; or show its end alone. */
  play({ joints, times, positions }, isEnd = false) {
    this.stopPlaying();
    const known = new Set(store.docks.joints);
    const at = (k) => Object.fromEntries(joints.map(({ joint }, i) => [joint, positions[k][i]]).filter(([joint]) => known.has(joint)));
    if (!times.length) return;
    this.stopPlaying = ticking((time) => {
      const next = isEnd ? -1 : times.findIndex((each) => each > time);
      const k = next < 0 ? times.length - 1 : next;
      showGhost(at(k), `rehearsed, ${number(times[k], 1)} of ${number(times.at(-1), 1)} s`);
      return next >= 0;
    });
  }

  close() {
    this.asked += 1;
    this.stopPlaying();
    if (!this.element.hidden) hideGhost();
    this.element.hidden = true;
  }

  /** Give the steps as they were rehearsed; the station refuses them if anything has changed. */
  async carryOut(steps, certificate) {
    this.close();
    for (const step of steps) {
      const [path, body] = requestOf(step);
      if (!(await act("POST", `${path}?certificate=${encodeURIComponent(certificate)}`, body))) return;
    }
    await store.refresh();
  }
}

const WITHOUT_CONTROLLER = "No trajectory controller of these joints is loaded: load one in the dock Controllers.";

/** Return route and body of a step that a page gives. */
function requestOf({ kind, name, path, start, stop, options, request }) {
  if (kind === "switch") return ["/controllers/switch", { start, stop }];
  if (kind === "path") return [`/waypoint-paths/${encodeURIComponent(path)}/play`, options];
  return [`/controllers/${name}/goals`, { goal: request }];
}

/** Return the controller of trajectories that moves these joints: one that runs, else one that can be started. */
function controllerFor(targets) {
  const found = store.docks.controllers.filter(({ type, resources }) => TRAJECTORY.test(type) && Object.keys(targets).every((joint) => resources.includes(joint)));
  return found.find(({ state }) => state === "running") ?? found[0];
}

/** Return the step that starts a controller, none when it runs. */
function startOf({ name, state, replaces }) {
  return state === "running" ? [] : [{ kind: "switch", start: [name], stop: replaces }];
}
