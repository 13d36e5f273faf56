// What a channel's key means, and its number in a frame of a stream; needs no page. A key is
// an address `source|path`, e.g. `robot_state/panda|tau_J_d/3` or `loop|loop/lateness/p99`, or
// stands for one; a part `@name` of the path is the entry of that name in a list.

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

const unitOf = (field) => UNITS.find(([pattern]) => pattern.test(field))?.[1] ?? "";
const isChannel = (value) => typeof value === "number" || typeof value === "boolean";
const nameOf = (entry) => entry?.name ?? entry?.arm_id ?? (entry?.bodies ? entry.bodies.join(" – ") : undefined);

/** Return the address of a usual channel, e.g. of `position/joint1`; `*` is the controller that has the joint. */
export function addressOf(key) {
  if (key.includes("|")) return key;
  const [first, second, element] = key.split("/");
  if (first === "sample") return `controller_state/*|${second}/@${element}`;
  if (/^(position|velocity|effort)$/.test(first)) return `joint_states|${first}/@${second}`;
  return `robot_state/${first}|${second}/${element}`;
}

/** Return the paths of all numbers in some data, e.g. `["loop/rate", "q/0"]`. */
export function numbersIn(data) {
  const found = [];
  const walk = (value, path) => {
    if (found.length >= MOST) return;
    // A statistic without a sample yet has no p99: it will have one.
    const isToCome = value === null && unitOf(path.at(-1)) !== "";
    if (isChannel(value) || isToCome) found.push(path.join("/"));
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

/** Return what a key stands for: {label, unit}. */
export function described(key) {
  const [source, path] = key.split("|");
  const parts = path.split("/");
  const field = parts.filter((part) => !/^(\d+|@.*)$/.test(part)).at(-1) ?? "";
  const short = source.replace(/^(robot_state|controller_state|published)\//, "");
  const words = parts.map((part) => (part.startsWith("@") ? part.slice(1) : /^\d+$/.test(part) ? `[${part}]` : part)).join(" ");
  const isArm = source.startsWith("robot_state");
  const unit = isArm && RADIANS.test(field) ? "rad" : unitOf(field);
  return { label: `${short} ${words}`, unit: isArm && field.includes("F_ext_hat_K") ? (Number(parts.at(-1)) < 3 ? "N" : "Nm") : unit };
}
