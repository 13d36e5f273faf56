// The station as the page sees it: requests, streams and teleoperation, through the gateway.
import { forPerson, refusals } from "./refusals.js";

const API = "/api/v1";
const AGAIN_MS = 700;
const LONGEST_LOOK_MS = 20000;
const REMEDY = "Look whether the station still runs; this page reconnects by itself.";

// A browser keeps six connections to the dashboard, for all its tabs, and a station that
// hangs would keep them all. So what has to go on to the station takes turns, a few looks
// and a few actions at a time, and looks at a station that is lost are given up: there is
// a connection left for STOP and for the strip. An action that still waits for its turn
// then is given up as well: nobody wants it done when the station is back.
class Turns {
  constructor(most) {
    this.free = most;
    this.waiting = [];
  }

  async take() {
    if (this.free > 0) this.free -= 1;
    else await new Promise((go, giveUp) => this.waiting.push({ go, giveUp }));
  }

  giveUp() {
    for (const one of this.waiting.splice(0)) one.giveUp(new Error("the station is lost"));
  }

  give() {
    const next = this.waiting.shift();
    if (next) next.go();
    else this.free += 1;
  }
}

const looks = new Turns(2);
const actions = new Turns(2);
let link = "";
let lost = new AbortController();
window.addEventListener("station-bar", ({ detail }) => {
  if (detail.link === "live" && link !== "live") for (const socket of [...broken]) socket.open();
  link = detail.link;
  if (link !== "lost") return;
  looks.giveUp();
  actions.giveUp();
  lost.abort();
  lost = new AbortController();
});

const isForStation = (path) => path.startsWith(API) || path.startsWith("/workspace/control");

async function fetched(method, path, options) {
  if (!isForStation(path)) return fetch(path, options);
  const turns = method === "GET" ? looks : actions;
  await turns.take();
  try {
    const signal = method === "GET" ? AbortSignal.any([lost.signal, AbortSignal.timeout(LONGEST_LOOK_MS)]) : undefined;
    return await fetch(path, { ...options, signal });
  } finally {
    turns.give();
  }
}

/** A refusal of the station, in its own words but for the routes. */
export class Refusal extends Error {
  constructor(status, { detail, code, remedy, errors, details }) {
    super(detail ?? `The request failed (${status}).`);
    Object.assign(this, { status, code: code ?? "", detail: this.message, remedy: forPerson(remedy ?? ""), errors: errors ?? [], details: details ?? {} });
  }
}

const linkIsLost = () => new Refusal(0, { code: "unreachable", detail: "The link to the station is lost.", remedy: REMEDY });

/** Send a request and return the JSON of its answer; throws a Refusal. */
export async function send(method, path, body, headers = {}) {
  // Looks at a station that is known to be lost would only take time from its return, and
  // an action would be done when nobody expects it any more. A stop is not refused here.
  const isRefused = isForStation(path) && path !== `${API}/stop`;
  if (link === "lost" && isRefused) throw linkIsLost();
  let answer;
  const isFile = body instanceof Blob;
  try {
    answer = await fetched(method, path, {
      method,
      headers: body === undefined ? headers : { "Content-Type": isFile ? "application/octet-stream" : "application/json", ...headers },
      body: body === undefined || isFile || typeof body === "string" ? body : JSON.stringify(body),
    });
  } catch {
    if (link === "lost" && isRefused) throw linkIsLost();
    throw new Refusal(0, { code: "unreachable", detail: "The dashboard does not answer.", remedy: REMEDY });
  }
  const content = answer.status === 204 ? {} : await answer.json().catch(() => undefined);
  if (answer.ok && content !== undefined) return content;
  throw answer.ok ? linkIsLost() : new Refusal(answer.status, content ?? {}); // cut off, or refused
}

export const api = (method, path, body, headers) => send(method, API + path, body, headers);

/** Return what the station has at a path; null without an answer: the strip says when it is lost. */
export const peek = (path) => api("GET", path).catch(() => null);

/** Wait for what a person has asked for: a refusal goes into the log and returns undefined. */
export async function said(promise, request = {}) {
  try {
    return await promise;
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    refusals.add(error, request);
    return undefined;
  }
}

/** Send a request for a person. */
export const act = (method, path, body, headers) => said(api(method, path, body, headers), { method, path, body });

const broken = new Set(); // sockets that wait to be opened again

/** A socket that opens again after the station or the dashboard has restarted. */
class Socket {
  constructor(path, onMessage) {
    Object.assign(this, { path, onMessage });
    this.open();
  }

  open() {
    clearTimeout(this.timer);
    broken.delete(this);
    this.socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${this.path}`);
    this.socket.onmessage = (event) => this.onMessage(JSON.parse(event.data));
    this.socket.onclose = () => {
      this.timer = setTimeout(() => this.open(), AGAIN_MS);
      broken.add(this);
    };
  }

  say(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  close() {
    clearTimeout(this.timer);
    broken.delete(this);
    this.socket.onclose = null;
    this.socket.close();
  }
}

const streams = new Map();

/** Call `hear` with every frame of a stream; returns what ends it. Streams are shared. */
export function follow(topic, query, hear) {
  const key = `${topic}?${query}`;
  let shared = streams.get(key);
  if (!shared) {
    const listeners = new Set();
    const tell = (frame) => {
      if (frame.topic !== "hello") for (const listener of listeners) listener(frame);
    };
    shared = { listeners, socket: new Socket(`${API}/streams/${key}`, tell) };
    streams.set(key, shared);
  }
  shared.listeners.add(hear);
  return () => {
    shared.listeners.delete(hear);
    if (shared.listeners.size > 0) return;
    shared.socket.close();
    streams.delete(key);
  };
}

/** The commands of a person to joints and hands; the dashboard makes set-points of them. */
class Teleoperation extends EventTarget {
  state = { controller: "", reason: "Waiting for the station.", remaining: 0 };

  connect() {
    this.socket ??= new Socket("/workspace/teleoperation", (state) => {
      if (state.refused) refusals.add(new Refusal(409, { code: state.code ?? "not_sent", detail: state.refused, remedy: state.remedy }));
      this.state = state;
      if (state.link === "live" && link !== "live") window.dispatchEvent(new Event("station-back"));
      this.dispatchEvent(new Event("change"));
    });
  }

  /** Say something that matters only to a motion that runs, and is said again before the next. */
  mention(message) {
    this.socket?.say(message);
  }

  say(message) {
    if (this.socket?.say(message)) return;
    refusals.add(new Refusal(0, { code: "not_sent", detail: "Not sent: this page may not move the robot, or is not connected." }));
  }
}

export const teleoperation = new Teleoperation();
