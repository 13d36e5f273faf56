// The channels of plots: every number that the station streams or answers.
import { addressOf, numberAt } from "./channel_maths.js";
import { follow, peek, store } from "./panel.js";

const FAST_HZ = 30;
const SLOW_HZ = 10;
const POLL_MS = 250;
const PATIENCE_MS = 30000; // a browser opens the streams of a page one by one, a busy one slowly
/** Return the sources there are now: {id, title, hz, silent, poll, isWhole}; a poll is a path, not a stream, and of a whole one no fields are asked for. */
export function sources() {
  const { arms, controllers } = store.docks;
  return [
    { id: "joint_states", title: "joint_states", hz: FAST_HZ, isWhole: true }, // which the page follows anyway
    ...arms.map(({ arm_id: arm }) => ({ id: `robot_state/${arm}`, title: `robot_state/${arm}`, hz: FAST_HZ })),
    ...controllers.map(({ name, state }) => ({ id: `controller_state/${name}`, title: `controller_state/${name}`, hz: FAST_HZ, silent: state !== "running" })),
    ...controllers.map(({ name }) => ({ id: `published/${name}`, title: `${name}: own data`, poll: `/controllers/${name}/state`, part: "published" })),
    { id: "loop", title: "loop: statistics", hz: SLOW_HZ },
    { id: "controllers", title: "controllers: time per update", hz: SLOW_HZ },
    { id: "scene", title: "scene: objects, contacts", hz: SLOW_HZ },
    ...arms.map(({ arm_id: arm }) => ({ id: `gripper/${arm}`, title: `${arm}: gripper`, poll: `/robots/${arm}/gripper` })),
  ];
}

const taken = (source, data) => (source.part ? data[source.part] : data);

/** Return one sample of a source, or null when it has none at the moment. */
export async function sample(source) {
  if (source.silent) return null;
  if (source.poll) return taken(source, (await peek(source.poll)) ?? {}) ?? null;
  const { promise, resolve } = Promise.withResolvers();
  setTimeout(resolve, PATIENCE_MS, null);
  return promise.finally(follow(source.id, `rate=${source.hz}`, (frame) => resolve(frame.data)));
}

/** Follow the sources of the wanted channels, and only them. */
export class Channels {
  /** `hear(key, time [s], value)` takes every number of a wanted channel, at most so many a second. */
  constructor(hear, most = FAST_HZ) {
    Object.assign(this, { hear, most });
    this.followed = new Map(); // source id to {query, end}
  }

  want(keys) {
    const paths = new Map(); // of the wanted channels by their keys, by source
    for (const key of keys) {
      const [source, path] = addressOf(key).split("|");
      const joint = path.split("@")[1];
      // What a joint is told, the controller says that moves it.
      const id = source.replace("*", () => store.docks.operated.names.find((each) => store.controller(each)?.resources.includes(joint)));
      if (!paths.has(id)) paths.set(id, new Map());
      paths.get(id).set(key, path);
    }
    const queryOf = (id) => paths.has(id) && [...paths.get(id).keys()].sort().join(",");
    for (const [id, { query, end }] of this.followed) {
      if (query === queryOf(id)) continue;
      end();
      this.followed.delete(id);
    }
    const begun = sources().filter(({ id }) => paths.has(id) && !this.followed.has(id));
    for (const source of begun) this.followed.set(source.id, { query: queryOf(source.id), end: this.begin(source, paths.get(source.id)) });
  }

  begin(source, paths) {
    const tell = (data, time) => {
      for (const [key, path] of paths) this.hear(key, time, numberAt(data, path));
    };
    if (!source.poll) {
      const fields = new Set([...paths.values()].map((path) => path.split("/")[0]));
      if (source.id.startsWith("controller_state") && [...paths.values()].some((path) => path.includes("/@"))) fields.add("name");
      const query = source.isWhole ? "" : `&fields=${[...fields].join(",")}`;
      return follow(source.id, `rate=${Math.min(source.hz, this.most)}${query}`, (frame) => tell(frame.data, frame.stamp));
    }
    const timer = setInterval(async () => {
      if (document.hidden) return;
      const answer = await peek(source.poll);
      if (answer) tell(taken(source, answer), store.stationTime);
    }, POLL_MS);
    return () => clearInterval(timer);
  }
}
