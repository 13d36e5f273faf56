// A recording as channels of plots: its columns, read when a plot asks for them; needs no page.
import { addressOf } from "./channel_maths.js";
import { History } from "./history.js";

/** Most samples of a channel that are read: the rows of a longer recording are thinned. */
const MOST = 20000;
const FIRST_COLUMNS = 4; // cycle, time, period, epoch
const POSITION = "joint_states/position/";

/** Return the column of a recording that has what a channel of the plots shows; undefined without one. */
export function columnOf(key, columns) {
  const [source, path] = addressOf(key).split("|");
  const [kind, owner] = source.split("/");
  const [field, ...rest] = path.replaceAll("@", "").split("/");
  const name = {
    recorded: path,
    joint_states: ["joint_states", field, ...rest].join("/"),
    robot_state: ["franka_state", owner, field.toLowerCase(), ...rest].join("/"),
    controller_state: ["controllers", owner, field, ...rest].join("/"),
  }[kind];
  const [start, end] = (name ?? "").split("*"); // any controller
  return columns.find((column) => (end === undefined ? column === name : column.startsWith(start) && column.endsWith(end)));
}

/** Return a table of CSV as {names, rows}, its cells as numbers. */
export function parsed(csv) {
  const [head, ...lines] = csv.trimEnd().split(/\r?\n/);
  return { names: head.split(","), rows: lines.map((line) => line.split(",").map(Number)) };
}

/** A run over the same time as others: the station's, from the begin of the first of them. */
export class Run {
  constructor({ kind = "live", id, name = id, begin = 0, end = 0, cycles = 0, events = [], columns = [] }) {
    Object.assign(this, { kind, id, name, begin, end, cycles, events, columns });
    this.offset = 0; // what is added to its own time since its begin [s]
    this.kept = new Map(); // by column or key: samples over the station's time
  }

  get duration() {
    return this.end - this.begin;
  }

  /** Put a moment of this run, in its station's time, at a common time [s]. */
  align(own, common) {
    this.offset = common - (own - this.begin);
  }

  common(time) {
    return time - this.begin + this.offset;
  }

  /** Return the name under which the samples of a channel are kept; undefined without such samples. */
  place(key) {
    return this.kind === "live" ? key : columnOf(key, this.columns);
  }

  /** Return which of some columns are not there yet. */
  missing(keys) {
    return [...new Set(keys.map((key) => this.place(key)))].filter((column) => column && !this.kept.has(column));
  }

  /** Take the columns of a table. */
  take({ names, rows }) {
    names.slice(FIRST_COLUMNS).forEach((name, i) => {
      const history = new History(Infinity);
      for (const row of rows) history.add(row[1], row[i + FIRST_COLUMNS]);
      this.kept.set(name, history);
    });
  }

  /** Return the samples of a channel over the common time; none where the run has no such channel. */
  history(key) {
    const { times, values } = this.kept.get(this.place(key)) ?? new History(Infinity);
    return Object.assign(new History(Infinity), { times: times.map((time) => this.common(time)), values });
  }

  /** Return the recorded positions at a common time, {joint: rad or m}. */
  pose(time) {
    const at = this.columns.filter((column) => column.startsWith(POSITION)).map((column) => [column.slice(POSITION.length), this.kept.get(column)?.nearest(time - this.offset + this.begin)]);
    return Object.fromEntries(at.filter(([, value]) => value !== undefined));
  }

  /** Return its events over the common time, as marks of the plots. */
  marks(prefix = "") {
    return this.events.map(({ time, until, text, kind }) => ({ at: this.common(time), until: until == null ? null : this.common(until), text: `${prefix}${text || kind}` }));
  }
}

/** Return a trial of an experiment as a run; `id` names the experiment and the role of the trial. */
export function runOfTrial(id, { joints, time, position, effort, desired }) {
  const parts = Object.entries({ "joint_states/position": position, "joint_states/effort": effort, "controllers/trial/desired": desired });
  const columns = ["cycle", "time", "period", "epoch", ...parts.flatMap(([part]) => joints.map((joint) => `${part}/${joint}`))];
  const run = new Run({ kind: "experiments", id, name: id.replace(":", ", "), begin: time[0], end: time.at(-1), cycles: time.length, columns });
  run.take({ names: columns, rows: time.map((at, k) => [k, at, 0, 0, ...parts.flatMap(([, rows]) => rows[k] ?? joints.map(() => null))]) });
  return run;
}

/** Return the query of a table with some columns, thinned when there are too many rows. */
export function tableQuery(columns, { duration, cycles }) {
  const query = new URLSearchParams(columns.map((column) => ["channels", column]));
  if (cycles > MOST) query.set("rate", String(MOST / duration));
  return query;
}

/** Return what of a link is a moment of a recording: {kind, id, time, other, layout}; null without a recording. */
export function ofLink(hash) {
  const query = new URLSearchParams(hash.replace(/^#/, ""));
  const kind = ["recording", "incident", "experiment"].find((name) => query.get(name));
  if (!kind) return null;
  const [otherKind, otherId, offset] = query.get("with")?.split("/") ?? [];
  const other = otherId ? { kind: otherKind, id: otherId, isOther: true, offset: Number(offset) || 0 } : null;
  return { kind: `${kind}s`, id: query.get(kind), time: query.has("t") ? Number(query.get("t")) || 0 : null, other, layout: query.get("layout") };
}

/** Return the link to a moment, after `#`. */
export function linkOf([run, other], time, layout) {
  const query = new URLSearchParams([[run.kind.slice(0, -1), run.id], ["t", time.toFixed(3)]]);
  if (other && other.kind !== "live") query.set("with", `${other.kind}/${other.id}/${other.offset.toFixed(4)}`);
  if (layout) query.set("layout", layout);
  return query.toString();
}
