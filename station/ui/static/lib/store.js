// What the page knows: polled state of the docks, and the newest frames of the streams.
import { act, follow, send } from "./station.js";

const POLL_MS = 350;
const ENABLING = "The controller is being started.";

class Store extends EventTarget {
  constructor() {
    super();
    this.bar = { link: "unknown", role: "" };
    this.docks = null;
    this.joints = null;
    this.arms = {};
    this.heardAt = 0;
    this.markers = []; // {at: station time [s], text}
    this.stationTime = 0;
    this.endOfArm = {};
    this.isEnabling = false; // while "Enable sliders" waits for the station
  }

  get isOperator() {
    return this.bar.role === "operator";
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
    this.poll();
  }

  async poll() {
    await this.refresh();
    setTimeout(() => this.poll(), document.hidden ? 2000 : POLL_MS);
  }

  async refresh() {
    try {
      const docks = await send("GET", "/workspace/state");
      this.notice(this.docks, docks);
      if (this.isEnabling) docks.enabling.reason ||= ENABLING;
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

  /** Mark in the plots what has changed: switches, stops, restarts. */
  notice(before, after) {
    if (!before) return;
    const states = new Map(before.controllers.map((c) => [c.name, c.state]));
    for (const c of after.controllers) {
      const was = states.get(c.name);
      if (was && was !== c.state && (c.state === "running" || was === "running"))
        this.mark(`${c.name} ${c.state === "running" ? "started" : "stopped"}`);
    }
    if (before.epoch !== null && after.epoch !== before.epoch) this.mark("stop, reset or recovery");
  }

  mark(text) {
    this.markers.push({ at: this.stationTime, text });
    if (this.markers.length > 200) this.markers.shift();
    this.dispatchEvent(new Event("marker"));
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

  controller(name) {
    return this.docks?.controllers.find((c) => c.name === name);
  }
}

export const store = new Store();

/** Start a controller; what holds its joints stops in the same cycle. */
export async function switchTo(name) {
  const stop = (await store.known(name))?.replaces ?? [];
  const done = await act("POST", "/controllers/switch", { start: [name], stop });
  await store.refresh();
  return done;
}

export async function stopController(name) {
  const done = await act("POST", "/controllers/switch", { start: [], stop: [name] });
  await store.refresh();
  return done;
}

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
    const loaded = await act("POST", "/controllers", {
      name: wanted.name,
      type: wanted.type,
      params: read.params,
    });
    if (!loaded) return;
  }
  await act("POST", "/controllers/switch", { start: [wanted.name, ...wanted.also], stop: wanted.replaces });
}
