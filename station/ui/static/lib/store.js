// What the page knows: polled state of the docks, and the newest frames of the streams.
import { changesGains, marksOf } from "./event_marks.js";
import { act, follow, send } from "./station.js";

const POLL_MS = 350;
const ENABLING = "The controller is being started.";
const OLD_POLL_MS = 3000; // an answer about the docks may be of the station before
const MOST_MARKERS = 200;
const EXPLAINED_MS = 3000;

class Store extends EventTarget {
  constructor() {
    super();
    this.bar = { link: "unknown", role: "" };
    this.holder = ""; // somebody else who holds control
    this.docks = null;
    this.joints = null;
    this.arms = {};
    this.heardAt = 0;
    this.markers = []; // {at: station time [s], text, what: the request, noted: page time [ms]}
    this.explained = new Map(); // text of a change of this page by its request, until its event comes
    this.bootId = "";
    this.begunAt = -Infinity;
    this.lastEvent = 0;
    this.stationTime = 0;
    this.endOfArm = {};
    this.isEnabling = false; // while "Enable sliders" waits for the station
  }

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
      this.followArms(docks.arms.map((arm) => arm.arm_id));
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
    this.explained.clear();
    for (const name of ["restart", "marker", "gains"]) this.dispatchEvent(new Event(name));
  }

  /** Hear an event of the station: it says when and what, whoever asked for it. */
  happened(event) {
    if (event.boot_id !== this.bootId) this.begin(event.boot_id);
    else if (event.id <= this.lastEvent) return; // a frame may come twice after a reconnection
    this.lastEvent = event.id;
    for (const text of marksOf(event)) this.mark(event.stamp, text, event.what);
    this.dispatchEvent(new CustomEvent("happened", { detail: event }));
    if (changesGains(event)) this.dispatchEvent(new Event("gains"));
  }

  mark(at, text, what) {
    const known = this.explained.get(what);
    this.explained.delete(what);
    const isKnown = known && performance.now() - known.noted < EXPLAINED_MS;
    this.markers.push({ at, text: isKnown ? known.text : text, what, noted: isKnown ? -Infinity : performance.now() });
    if (this.markers.length > MOST_MARKERS) this.markers.shift();
    this.dispatchEvent(new Event("marker"));
  }

  /** Say what a request of this page has changed; its moment comes, or came, as an event. */
  explain(what, text) {
    const marker = this.markers.findLast((one) => one.what === what && performance.now() - one.noted < EXPLAINED_MS);
    if (!marker) return this.explained.set(what, { text, noted: performance.now() });
    Object.assign(marker, { text, noted: -Infinity });
    return this.dispatchEvent(new Event("marker"));
  }

  followArms(names) {
    for (const name of Object.keys(this.endOfArm))
      if (!names.includes(name)) {
        this.endOfArm[name]();
        delete this.endOfArm[name];
        delete this.arms[name];
      }
    const fields = "q,dq,tau_J,tau_ext_hat_filtered,O_T_EE,O_F_ext_hat_K,q_d,tau_J_d";
    for (const name of names)
      this.endOfArm[name] ??= follow(`robot_state/${name}`, `rate=30&fields=${fields}`, (frame) => {
        this.arms[name] = { ...frame.data, stamp: frame.stamp };
      });
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
    await startWanted(wanted);
  } finally {
    store.isEnabling = false;
    await store.refresh();
  }
}

async function startWanted(wanted) {
  if (wanted.type) {
    const read = await send("POST", "/workspace/parameters", wanted.parameters);
    if (!(await act("POST", "/controllers", { name: wanted.name, type: wanted.type, params: read.params }))) return;
  }
  await act("POST", "/controllers/switch", { start: [wanted.name, ...wanted.also], stop: wanted.replaces });
}
