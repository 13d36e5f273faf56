// Recordings that are open: the time of the replay, and what is read of them. It moves nothing.
import { hideGhost, showGhost } from "./ghost.js";
import { Run, parsed, linkOf, tableQuery } from "./recorded.js";
import { refusals } from "./refusals.js";
import { act, api, Refusal } from "./station.js";
import { store } from "./store.js";
import { number } from "./text.js";

const TICK_MS = 50;
const MOST = 2; // runs over each other
const AT_FIRST = ["joint_states/position"];

/** Return a table of a recording; a long one takes as long as it takes. */
async function table(run, columns) {
  const answer = await fetch(`/api/v1/${run.kind}/${encodeURIComponent(run.id)}/table?${tableQuery(columns, run)}`);
  if (!answer.ok) throw new Refusal(answer.status, await answer.json().catch(() => ({})));
  return parsed(await answer.text());
}

/** Return the names of all columns: the first line of a table that is not read further. */
async function columnsOf(kind, id) {
  const answer = await fetch(`/api/v1/${kind}/${encodeURIComponent(id)}/table?rate=0.001`);
  if (!answer.ok) throw new Refusal(answer.status, await answer.json().catch(() => ({})));
  return parsed(await answer.text()).names;
}

class Replay extends EventTarget {
  constructor() {
    super();
    this.runs = []; // the first has the time that the others are shifted to
    this.time = 0; // since the begin of the first [s]
    this.speed = 1;
    this.timer = null;
    this.reading = "";
  }

  get isOpen() {
    return this.runs.length > 0;
  }

  get duration() {
    return this.runs[0]?.duration ?? 0;
  }

  get isPlaying() {
    return this.timer !== null;
  }

  tell(what) {
    this.dispatchEvent(new Event(what));
  }

  /** Open a recording or an incident, over the one that is open if it is a comparison; return it, or undefined. */
  async open(kind, id, { isOther = false, time = null } = {}) {
    this.say(`Reading ${id} …`);
    try {
      const info = await api("GET", `/${kind}/${encodeURIComponent(id)}`);
      const run = new Run({ kind, id: info.identifier, name: info.name && info.name !== "incident" ? info.name : info.identifier, begin: 0, end: info.duration, columns: await columnsOf(kind, id) });
      run.cycles = info.cycles;
      const first = await table(run, AT_FIRST);
      run.begin = first.rows[0][1];
      run.end = first.rows.at(-1)[1];
      run.take(first);
      run.joints = first.names.filter((name) => name.startsWith(`${AT_FIRST[0]}/`)).map((name) => name.slice(AT_FIRST[0].length + 1));
      await this.readEvents(run);
      this.put(run, isOther, time);
      return run;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refusals.add(error, {});
      return undefined;
    } finally {
      this.say("");
    }
  }

  async readEvents(run) {
    run.events = (await api("GET", `/${run.kind}/${encodeURIComponent(run.id)}/events`)).events;
  }

  /** Show a run; an incident begins at the moment of its cause. */
  put(run, isOther, time) {
    const cause = run.events.find(({ kind }) => kind === "incident");
    if (isOther && this.isOpen) {
      this.runs = [...this.runs.slice(0, MOST - 1), run];
      const own = this.runs[0].events.find(({ kind }) => kind === "incident");
      if (own && cause) run.align(cause.time, this.runs[0].common(own.time));
    } else {
      this.pause();
      this.runs = [run];
      this.time = time ?? (cause ? run.common(cause.time) : 0);
    }
    this.tell("runs");
    this.seek(this.time);
  }

  say(text) {
    this.reading = text;
    this.tell("change");
  }

  /** Read the columns that the channels of the plots need. */
  async want(keys) {
    for (const run of this.runs) {
      const missing = run.kind === "live" ? [] : run.missing(keys);
      if (!missing.length) continue;
      for (const column of missing) run.kept.set(column, null); // asked for once
      this.say("Reading …");
      const found = await table(run, missing).catch((error) => refusals.add(error, {}));
      if (found) run.take(found);
      this.say("");
      this.tell("samples");
    }
  }

  drop(run) {
    this.runs = this.runs.filter((other) => other !== run);
    if (!this.isOpen) return this.close();
    this.runs[0].align(this.runs[0].begin, 0);
    this.tell("runs");
    return this.seek(Math.min(this.time, this.duration));
  }

  close() {
    this.pause();
    this.runs = [];
    hideGhost();
    this.note();
    this.tell("runs");
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.duration);
    const known = new Set(store.docks?.joints);
    const pose = Object.entries(this.runs[0].pose(this.time)).filter(([joint]) => known.has(joint));
    if (pose.length) showGhost(Object.fromEntries(pose), `recorded, ${number(this.time, 1)} of ${number(this.duration, 1)} s`);
    this.tell("change");
    if (!this.isPlaying) this.note();
  }

  play() {
    let [from, began] = [this.time < this.duration - 0.01 ? this.time : 0, performance.now()];
    let speed = this.speed;
    this.timer = setInterval(() => {
      if (speed !== this.speed) [from, began, speed] = [this.time, performance.now(), this.speed];
      const time = from + ((performance.now() - began) / 1000) * speed;
      if (time >= this.duration) this.pause();
      this.seek(time);
    }, TICK_MS);
    this.tell("change");
  }

  pause() {
    clearInterval(this.timer);
    this.timer = null;
    this.tell("change");
  }

  /** Align an event of a run with one of the first, in their stations' times [s]. */
  align(run, own, of) {
    run.align(own, this.runs[0].common(of));
    this.tell("runs");
    this.seek(this.time);
  }

  /** Write a note on a moment or a range of the first recording into its file. */
  async addNote(text, begin, until) {
    const [run] = this.runs;
    const clamp = (time) => Math.min(Math.max(time + run.begin, run.begin), run.end);
    const note = await act("POST", `/${run.kind}/${encodeURIComponent(run.id)}/notes`, { text, time: clamp(begin), until: until === null ? null : clamp(until) });
    if (!note) return false;
    await this.readEvents(run);
    this.tell("runs");
    return true;
  }

  marks() {
    return this.runs.flatMap((run, i) => run.marks(this.runs.length > 1 ? `${"AB"[i]}: ` : ""));
  }

  /** Return the address of this moment, with what the plots show. */
  link(layout) {
    return `${location.origin}${location.pathname}#${linkOf(this.runs, this.time, layout)}`;
  }

  /** Keep the address of the page that of what is open, so that a reload comes back to it. */
  note() {
    const hash = this.isOpen && this.runs[0].kind !== "live" ? `#${linkOf(this.runs, this.time, "")}` : "";
    history.replaceState(null, "", location.pathname + location.search + hash);
  }
}

export const replay = new Replay();
