// The station as the page sees it: requests, streams and the desk, through the gateway.
import { refusals } from "./refusals.js";

const API = "/api/v1";
const AGAIN_MS = 700;

/** A refusal of the station, in its own words. */
export class Refusal extends Error {
  constructor(status, problem) {
    super(problem.detail ?? `The request failed (${status}).`);
    this.status = status;
    this.code = problem.code ?? "";
    this.detail = this.message;
    this.remedy = problem.remedy ?? "";
    this.errors = problem.errors ?? [];
    this.details = problem.details ?? {};
  }
}

/** Send a request and return the JSON of its answer; throws a Refusal. */
export async function send(method, path, body, headers = {}) {
  let answer;
  try {
    answer = await fetch(path, {
      method,
      headers: body === undefined ? headers : { "Content-Type": "application/json", ...headers },
      body: body === undefined ? undefined : typeof body === "string" ? body : JSON.stringify(body),
    });
  } catch {
    throw new Refusal(0, {
      code: "unreachable",
      detail: "The dashboard does not answer.",
      remedy: "Look whether the station still runs; this page reconnects by itself.",
    });
  }
  const told = answer.status === 204 ? {} : await answer.json().catch(() => ({}));
  if (!answer.ok) throw new Refusal(answer.status, told);
  return told;
}

export const api = (method, path, body, headers) => send(method, API + path, body, headers);

/** Send a request for a person: a refusal goes into the log and returns undefined. */
export async function act(method, path, body, headers) {
  try {
    return await api(method, path, body, headers);
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    refusals.add(error, { method, path, body });
    return undefined;
  }
}

function address(path) {
  return `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${path}`;
}

/** A socket that opens again after the station or the dashboard has restarted. */
class Socket {
  constructor(path, onMessage) {
    this.path = path;
    this.onMessage = onMessage;
    this.wanted = true;
    this.open();
  }

  open() {
    if (!this.wanted) return;
    this.socket = new WebSocket(address(this.path));
    this.socket.onmessage = (event) => this.onMessage(JSON.parse(event.data));
    this.socket.onclose = () => setTimeout(() => this.open(), AGAIN_MS);
  }

  say(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  close() {
    this.wanted = false;
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

/** The desk: what a person asks of joints and hand; the gateway makes set-points of it. */
class Desk extends EventTarget {
  constructor() {
    super();
    this.state = { controller: "", reason: "Waiting for the station.", remaining: 0 };
  }

  connect() {
    this.socket ??= new Socket("/workspace/desk", (told) => {
      if (told.refused)
        refusals.add(
          new Refusal(409, { code: told.code ?? "not_sent", detail: told.refused, remedy: told.remedy }),
          {},
        );
      this.state = told;
      this.dispatchEvent(new Event("change"));
    });
  }

  say(message) {
    if (this.socket?.say(message)) return;
    refusals.add(
      new Refusal(0, { code: "not_sent", detail: "Not sent: this page may not move the robot, or is not connected." }),
      {},
    );
  }
}

export const desk = new Desk();
