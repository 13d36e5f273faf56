// Every number that the station streams or answers, as channels for plots. A channel's key
// is `source|path`, e.g. `robot_state/panda|tau_J_d/3` or `loop|loop/lateness/p99`; a part
// `@name` of the path is the entry of that name in a list.
import { api, follow } from "./station.js";
import { store } from "./store.js";

const FAST_HZ = 30;
const SLOW_HZ = 10;
const POLL_MS = 250;
const PATIENCE_MS = 30000; // a browser opens the streams of a page one by one, a busy one slowly
const MOST = 2000; // numbers of one source

/** Units of the fields; a field that is not here says its unit in the API's description. */
const UNITS = [
  [/^(position|q|q_d|theta|desired|actual|error)$/, ""],
  [/^(velocity|dq|dq_d|dtheta)$/, "rad/s"],
  [/^ddq_d$/, "rad/s²"],
  [/^(effort|output|tau_J|tau_J_d|tau_ext_hat_filtered)$/, "Nm"],
  [/^dtau_J$/, "Nm/s"],
  [/^(m_ee|m_load|m_total|mass)$/, "kg"],
  [/^(p50|p99|p999|max|period|time|stamp)$/, "s"],
  [/rate$/, "Hz"],
  [/^(width|max_width)$/, "m"],
  [/^force$/, "N"],
];
const RADIANS = /^(q|q_d|theta)$/;

/** Return the sources there are now: {id, title, hz, silent, poll}; a poll is a path, not a stream. */
export function sources() {
  const { arms, controllers } = store.docks;
  return [
    { id: "joint_states", title: "joint_states", hz: FAST_HZ },
    ...arms.map(({ arm_id: arm }) => ({ id: `robot_state/${arm}`, title: `robot_state/${arm}`, hz: FAST_HZ })),
    ...controllers.map(({ name, state }) => ({ id: `controller_state/${name}`, title: `controller_state/${name}`, hz: FAST_HZ, silent: state !== "running" })),
    ...controllers.map(({ name }) => ({ id: `published/${name}`, title: `${name}: own data`, poll: `/controllers/${name}/state`, part: "published" })),
    { id: "loop", title: "loop: statistics", hz: SLOW_HZ },
    { id: "controllers", title: "controllers: time per update", hz: SLOW_HZ },
    { id: "scene", title: "scene: objects, contacts", hz: SLOW_HZ },
    ...arms.map(({ arm_id: arm }) => ({ id: `gripper/${arm}`, title: `${arm}: gripper`, poll: `/robots/${arm}/gripper` })),
  ];
}

const isChannel = (value) => typeof value === "number" || typeof value === "boolean";
const nameOf = (entry) => entry?.name ?? entry?.arm_id ?? (entry?.bodies ? entry.bodies.join(" – ") : undefined);

/** Return the paths of all numbers in some data, e.g. `["loop/rate", "q/0"]`. */
export function numbersIn(data) {
  const found = [];
  const walk = (value, path) => {
    if (found.length >= MOST) return;
    if (isChannel(value)) found.push(path.join("/"));
    else if (Array.isArray(value)) value.forEach((each, i) => walk(each, [...path, segment(value, i, data)]));
    else if (value && typeof value === "object") for (const [key, each] of Object.entries(value)) walk(each, [...path, key]);
  };
  walk(data, []);
  return found;
}

/** Name the entry of a list by itself, or by the list `name` beside it, or by its number. */
function segment(list, i, data) {
  const own = nameOf(list[i]);
  const beside = Array.isArray(data.name) && data.name.length === list.length && isChannel(list[i]) ? data.name[i] : undefined;
  const name = own ?? beside;
  return name === undefined || name.includes("/") ? String(i) : `@${name}`;
}

/** Return the number at a path, true as 1; undefined when it is not there. */
export function numberAt(data, path) {
  let value = data;
  for (const part of path.split("/")) {
    if (value == null) return undefined;
    if (part.startsWith("@") && Array.isArray(value)) {
      const name = part.slice(1);
      const i = isChannel(value[0]) ? data.name?.indexOf(name) : value.findIndex((entry) => nameOf(entry) === name);
      value = value[i];
    } else value = value[part];
  }
  return isChannel(value) ? Number(value) : undefined;
}

/** Return what a key stands for: {label, unit, group}. */
export function described(key) {
  const [source, path] = key.split("|");
  const parts = path.split("/");
  const field = parts.filter((part) => !/^(\d+|@.*)$/.test(part)).at(-1) ?? "";
  const short = source.replace(/^(robot_state|controller_state|published)\//, "");
  const words = parts.map((part) => (part.startsWith("@") ? part.slice(1) : /^\d+$/.test(part) ? `[${part}]` : part)).join(" ");
  const isArm = source.startsWith("robot_state");
  const unit = isArm && RADIANS.test(field) ? "rad" : (UNITS.find(([pattern]) => pattern.test(field))?.[1] ?? "");
  return { label: `${short} ${words}`, unit: isArm && field.includes("F_ext_hat_K") ? (Number(parts.at(-1)) < 3 ? "N" : "Nm") : unit, group: source };
}

const taken = (source, data) => (source.part ? data[source.part] : data);

/** Return one sample of a source, or null when it has none at the moment. */
export async function sample(source) {
  if (source.silent) return null;
  if (source.poll) return taken(source, await api("GET", source.poll).catch(() => ({}))) ?? null;
  return new Promise((resolve) => {
    const done = (data) => {
      clearTimeout(timer);
      end();
      resolve(data);
    };
    const timer = setTimeout(() => done(null), PATIENCE_MS);
    const end = follow(source.id, `rate=${source.hz}`, (frame) => done(frame.data));
  });
}

/** Follow the sources of the wanted channels, and only them. */
export class Channels {
  /** `hear(key, time [s], value)` takes every number of a wanted channel. */
  constructor(hear) {
    this.hear = hear;
    this.followed = new Map(); // source id to {query, end}
  }

  want(keys) {
    const paths = new Map();
    for (const key of keys) {
      const [id, path] = key.split("|");
      if (path !== undefined) paths.set(id, [...(paths.get(id) ?? []), path]);
    }
    for (const [id, { end }] of [...this.followed]) if (!paths.has(id)) this.end(id, end);
    const known = new Map(sources().map((source) => [source.id, source]));
    for (const [id, list] of paths) {
      const query = list.sort().join(",");
      const before = this.followed.get(id);
      if (before?.query === query) continue;
      if (before) this.end(id, before.end);
      const source = known.get(id);
      if (source) this.followed.set(id, { query, end: this.begin(source, list) });
    }
  }

  end(id, end) {
    end();
    this.followed.delete(id);
  }

  begin(source, paths) {
    const tell = (data, time) => {
      for (const path of paths) this.hear(`${source.id}|${path}`, time, numberAt(data, path));
    };
    if (!source.poll) {
      const fields = new Set(paths.map((path) => path.split("/")[0]));
      if (paths.some((path) => path.includes("/@")) && /^(joint_states|controller_state)/.test(source.id)) fields.add("name");
      return follow(source.id, `rate=${source.hz}&fields=${[...fields].join(",")}`, (frame) => tell(frame.data, frame.stamp));
    }
    const timer = setInterval(async () => {
      if (document.hidden) return;
      const told = await api("GET", source.poll).catch(() => null);
      if (told) tell(taken(source, told), store.stationTime);
    }, POLL_MS);
    return () => clearInterval(timer);
  }
}
