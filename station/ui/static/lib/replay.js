// Recordings that are open: the time of the replay, and what is read of them. It moves nothing.
import { hideGhost, showGhost, ticking } from "./ghost.js";
import { Run, parsed, linkOf, runOfTrial, tableQuery } from "./recorded.js";
import { act, api, number, Refusal, refusals, said, store } from "./panel.js";

const POSITION = "joint_states/position";

const pathOf = ({ kind, id }) => `/${kind}/${encodeURIComponent(id)}`;

/** Return a table of a recording; a long one takes as long as it takes. */
async function table(run, query) {
  const answer = await fetch(`/api/v1${pathOf(run)}/table?${query}`);
  if (!answer.ok) throw new Refusal(answer.status, await answer.json().catch(() => ({})));
  return parsed(await answer.text());
}

/** Return a recording or an incident with its columns, its positions and its events. */
async function recorded(kind, id) {
  const info = await api("GET", pathOf({ kind, id }));
  const run = new Run({ kind, id: info.identifier, name: kind === "incidents" ? info.identifier : info.name || info.identifier, cycles: info.cycles });
  // Few rows of it say which columns there are.
  run.columns = (await table(run, "rate=0.001")).names;
  const first = await table(run, tableQuery([POSITION], { ...info }));
  Object.assign(run, { begin: first.rows[0][1], end: first.rows.at(-1)[1] });
  run.take(first);
  await readEvents(run);
  return run;
}

async function readEvents(run) {
  run.events = (await api("GET", `${pathOf(run)}/events`)).events;
}

/** Return a trial of an experiment; the last one that was kept if none has that role. */
async function trial(id) {
  const [name, role] = id.split(":");
  const { responses } = await api("GET", `/experiments/${encodeURIComponent(name)}/responses`);
  const found = responses.find((one) => one.role === role) ?? responses.at(-1);
  if (!found) throw new Refusal(404, { code: "no_trial", detail: `The experiment ${name} has kept no trial yet.`, remedy: "Wait until its first trial has ended." });
  return runOfTrial(`${name}:${found.role}`, found);
}

class Replay extends EventTarget {
  runs = []; // the first has the time that the others are shifted to
  time = 0; // since the begin of the first [s]
  speed = 1;
  stop = null; // ends what plays
  reading = "";

  get isOpen() {
    return this.runs.length > 0;
  }

  get duration() {
    return this.runs[0]?.duration ?? 0;
  }

  get isPlaying() {
    return this.stop !== null;
  }

  tell(what) {
    this.dispatchEvent(new Event(what));
  }

  /** Open a recording, an incident or a trial, over the one that is open if it is a comparison; return it, or undefined. */
  async open({ kind, id, isOther = false, time = null, offset = null }) {
    this.say(`Reading ${id} …`);
    const run = await said(kind === "experiments" ? trial(id) : recorded(kind, id));
    if (run) this.put(run, { isOther, time, offset });
    this.say("");
    return run;
  }

  /** Show a run; an incident begins at the moment of its cause. */
  put(run, { isOther = false, time = null, offset = null }) {
    const causeOf = ({ events }) => events.find(({ kind }) => kind === "incident");
    const cause = causeOf(run);
    if (isOther && this.isOpen) {
      const [first] = this.runs;
      this.runs = [first, run];
      if (offset !== null) run.offset = offset;
      else if (causeOf(first) && cause) run.align(cause.time, first.common(causeOf(first).time));
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
      const found = await table(run, tableQuery(missing, run)).catch((error) => refusals.add(error, {}));
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
    let time = this.time < this.duration - 0.01 ? this.time : 0;
    let before = 0;
    this.stop = ticking((now) => {
      time += (now - before) * this.speed;
      before = now;
      if (time >= this.duration) this.pause();
      this.seek(time);
    });
    this.tell("change");
  }

  pause() {
    this.stop?.();
    this.stop = null;
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
    const note = await act("POST", `${pathOf(run)}/notes`, { text, time: clamp(begin), until: until === null ? null : clamp(until) });
    if (!note) return false;
    await readEvents(run);
    this.tell("runs");
    return true;
  }

  marks() {
    return this.runs.flatMap((run, i) => run.marks(this.runs.length > 1 ? `${"AB"[i]}: ` : ""));
  }

  /** Return the address of this moment, with what the plots show. */
  link(layout) {
    return `${location.origin}${location.pathname}${this.isOpen ? `#${linkOf(this.runs, this.time, layout)}` : ""}`;
  }

  /** Keep the address of the page that of what is open, so that a reload comes back to it. */
  note() {
    history.replaceState(null, "", this.link(""));
  }
}

export const replay = new Replay();
