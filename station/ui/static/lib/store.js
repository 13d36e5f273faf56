// What the page knows: polled state of the docks, and the newest frames of the streams.
import { act, follow, send } from "./station.js";

const POLL_MS = 350;
const ENABLING = "The controller is being started.";
const OLD_POLL_MS = 3000; // an answer about the docks may be of the station before
const MOST_MARKERS = 200;

/** Return what an event is marked as in the plots: no text, or several. */
function marksOf({ kind, what, result, severity, details }) {
  if (kind === "switch") return [...(details.stopped ?? []).map((name) => `${name} stopped`), ...(details.started ?? []).map((name) => `${name} started`)];
  if (kind === "fault") return [`${what} stopped by a fault`];
  if (kind === "stop") return result === "stopped" ? ["stop"] : [];
  if (kind === "robot_mode") return severity === "error" ? [`robot: ${result}`] : [];
  return details.mark ? [details.mark] : [];
}

class Store extends EventTarget {
  bar = { link: "unknown", role: "" };
  holder = ""; // somebody else who holds control
  docks = null;
  joints = null;
  heardAt = 0;
  markers = []; // {at: station time [s], text}
  bootId = "";
  begunAt = -Infinity;
  lastEvent = 0;
  stationTime = 0;
  isEnabling = false; // while "Enable sliders" waits for the station

  get isOperator() {
    return this.bar.role === "operator";
  }

  /** Return whether the station may do what needs nothing, to "change" something, or "motion", which a stop bars. */
  can(needs) {
    const isBarred = needs === "motion" && ["stopped", "released"].includes(this.stop);
    return !needs || (this.isOperator && !this.holder && !isBarred);
  }

  get stop() {
    return this.bar.stop_state;
  }

  /** Return whether an arm is in a mode of the robot; any arm, without a name. */
  isArmIn(mode, arm) {
    return Boolean(this.docks?.arms.some((one) => one.robot_mode === mode && (!arm || one.arm_id === arm)));
  }

  start() {
    follow("joint_states", "rate=30", (frame) => {
      this.joints = frame.data;
      this.stationTime = frame.stamp;
      this.heardAt = performance.now();
      this.dispatchEvent(new Event("joints"));
    });
    follow("events", "rate=10", (frame) => this.happened(frame.data));
    this.poll();
  }

  async poll() {
    await this.refresh();
    setTimeout(() => this.poll(), document.hidden ? 2000 : POLL_MS);
  }

  async refresh() {
    try {
      const docks = await send("GET", "/workspace/state");
      if (this.isEnabling) docks.enabling.reason ||= ENABLING;
      const isOld = performance.now() - this.begunAt < OLD_POLL_MS;
      if (docks.boot_id && docks.boot_id !== this.bootId && !isOld) this.begin(docks.boot_id);
      this.docks = docks;
      this.dispatchEvent(new Event("docks"));
    } catch {
      // The strip says that the dashboard does not answer; the next poll may.
    }
  }

  /** Return a controller; one that has just been loaded is waited for, at most 2 s. */
  async known(name) {
    for (let tries = 0; tries < 20 && !this.controller(name); tries += 1) {
      await new Promise((resolve) => setTimeout(resolve, 100));
      await this.refresh();
    }
    return this.controller(name);
  }

  /** Another run of the station: its time begins anew, so that old marks would be at wrong times. */
  begin(bootId) {
    const isAnother = this.bootId !== "";
    this.bootId = bootId;
    this.lastEvent = 0;
    if (!isAnother) return;
    this.begunAt = performance.now();
    this.markers = [];
    for (const name of ["restart", "marker", "gains"]) this.dispatchEvent(new Event(name));
  }

  /** Hear an event of the station: it says when and what, whoever asked for it. */
  happened(event) {
    if (event.boot_id !== this.bootId) this.begin(event.boot_id);
    else if (event.id <= this.lastEvent) return; // a frame may come twice after a reconnection
    this.lastEvent = event.id;
    this.markers.push(...marksOf(event).map((text) => ({ at: event.stamp, text })));
    this.markers.splice(0, this.markers.length - MOST_MARKERS);
    this.dispatchEvent(new Event("marker"));
    this.dispatchEvent(new CustomEvent("happened", { detail: event }));
    if (event.details.mark?.startsWith("gain")) this.dispatchEvent(new Event("gains"));
  }

  /** Return where joints are now [rad] or [m]. */
  positionsOf(joints) {
    return joints.map((joint) => this.joints.position[this.joints.name.indexOf(joint)]);
  }

  controller(name) {
    return this.docks?.controllers.find((c) => c.name === name);
  }
}

export const store = new Store();

async function change(start, stop) {
  const done = await act("POST", "/controllers/switch", { start, stop });
  await store.refresh();
  return done;
}

/** Start a controller; what holds its joints stops in the same cycle. */
export const switchTo = async (name) => change([name], (await store.known(name))?.replaces ?? []);

export const stopController = (name) => change([], [name]);

/** Stop a controller and start it again; the station takes one of the two in a switch. */
export async function restartController(name) {
  const stopped = await stopController(name);
  return stopped && switchTo(name);
}

/** Start what makes the joints take values; load it first if no such thing is loaded. */
export async function enableSliders() {
  const wanted = store.docks?.enabling;
  if (!wanted?.name || store.isEnabling) return;
  store.isEnabling = true;
  store.docks.enabling = { ...wanted, reason: wanted.reason || ENABLING };
  store.dispatchEvent(new Event("docks"));
  try {
    const { name, type, parameters, also, replaces } = wanted;
    const params = type && (await send("POST", "/workspace/parameters", parameters)).params;
    if (!type || (await act("POST", "/controllers", { name, type, params }))) await act("POST", "/controllers/switch", { start: [name, ...also], stop: replaces });
  } finally {
    store.isEnabling = false;
    await store.refresh();
  }
}
