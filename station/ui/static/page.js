// The strip: status, and a stop that depends neither on Viser's page nor on the docks.
// The docks hear of its state by the event `station-bar`. Their event `station-back` only
// spares a question.
"use strict";

const POLL_MS = 300;
const POLL_LOST_MS = 100; // the station may be back at any moment
const PATIENCE_MS = 2000;
const STOP_PATIENCE_MS = 5000;
const MOTION = { armed: "allowed", stopped: "STOPPED", released: "not allowed yet" };

const element = (id) => document.getElementById(id);
const show = (id, text) => {
  if (element(id).textContent !== text) element(id).textContent = text;
};

const NOT_STOPPED = "NOT stopped by this page. Press the emergency stop.";
const NOT_STOPPED_MS = 5000; // to be read even if the link is back at once
let stopFailedAt = 0; // 0: all is well
let noticeUntil = 0;
function notice(text, holdMs = 8000) {
  if (stopFailedAt) return; // nothing else matters as much
  const line = element("notice");
  line.textContent = text;
  line.hidden = !text;
  noticeUntil = Date.now() + holdMs;
}

// Give a request up after some time in which this page could have taken the answer. While
// a slow picture of the 3D view is drawn it cannot, and that says nothing of the dashboard.
const TURN_MS = 100;
async function patiently(path, ms, options = {}) {
  const giveUp = new AbortController();
  let turns = ms / TURN_MS;
  const timer = setInterval(() => (turns -= 1) <= 0 && giveUp.abort(), TURN_MS);
  try {
    return await fetch(path, { ...options, signal: giveUp.signal });
  } finally {
    clearInterval(timer);
  }
}

async function post(path) {
  const answer = await patiently(path, STOP_PATIENCE_MS, { method: "POST" });
  const body = await answer.json();
  if (!answer.ok) throw Object.assign(new Error(`${body.detail} ${body.remedy ?? ""}`), { refusal: { ...body, status: answer.status } });
  return body;
}

// A refusal belongs into the log of the docks. Without them it is a notice.
function refuse(refusal, path) {
  const heard = new CustomEvent("station-refused", { detail: { refusal, path }, cancelable: true });
  if (window.dispatchEvent(heard)) notice(`${refusal.detail} ${refusal.remedy ?? ""}`);
}

// What the station has answered to a stop or a release is newer than what the dashboard
// polled before: it is shown until a poll says the same, or for this long while the link
// is live. A station that hangs tells the dashboard nothing, and its watchdog answers.
const ANSWER_HOLDS_MS = 1500;
let answered = { state: "", until: 0 };
let latest = null;
let refusedBefore = "";

function showAnswer(answer) {
  answered = { state: answer.state, until: Date.now() + ANSWER_HOLDS_MS };
  if (latest) render(latest);
}

function newest(state) {
  if (state.stop_state === answered.state) answered.state = "";
  if (state.link === "live" && Date.now() > answered.until) answered.state = "";
  return answered.state ? { ...state, stop_state: answered.state } : state;
}

async function stop() {
  element("stop").classList.add("busy");
  try {
    showAnswer(await post("/stop"));
    stopFailedAt = 0;
    notice("");
  } catch (error) {
    console.warn(error.message); // for whoever looks for the cause; a person at a robot has no time for it
    stopFailedAt = 0;
    notice(NOT_STOPPED, Infinity);
    stopFailedAt = Date.now();
  } finally {
    element("stop").classList.remove("busy");
    refresh();
  }
}

async function act(path) {
  try {
    showAnswer(await post(path));
  } catch (error) {
    const remedy = "Look at the strip whether it was done, and try again.";
    refuse(error.refusal ?? { code: "unreachable", detail: `It is not known whether it was done: ${error.message}`, remedy }, path);
  }
  refresh();
}

function linkText(state) {
  if (state.link === "live") return "live";
  if (state.age === null) return "no data yet";
  return `${state.link}, data ${state.age.toFixed(1)} s old`;
}

function render(polled) {
  latest = polled;
  const state = newest(polled);
  const bar = element("bar");
  bar.dataset.link = state.link;
  bar.dataset.stop = state.stop_state;
  show("link", linkText(state));
  show("motion", MOTION[state.stop_state] ?? "–");
  show("robot", state.robot || "–");
  element("robot").dataset.real = String(state.robot.startsWith("REAL"));
  show("mode", state.mode || "–");
  element("mode").title = state.mode;
  show("rate", state.rate_hz === null ? "–" : `${state.rate_hz.toFixed(0)} Hz`);
  const late = state.lateness_p99;
  show("lateness", late === null ? "–" : `${(late * 1e3).toFixed(2)} ms`);
  const factor = state.real_time_factor;
  show("factor", state.paused ? "paused" : factor == null ? "–" : `× ${factor.toFixed(2)}`);
  show("epoch", state.epoch === null ? "–" : String(state.epoch));
  element("motion").title = state.stop_reason;
  const operator = state.role === "operator";
  element("role").hidden = operator;
  element("release").hidden = !operator || state.stop_state !== "stopped";
  element("arm").hidden = !operator || state.stop_state !== "released";
  // Of the panel that Viser draws, which is one for all browsers, and of pulls.
  if (state.refused && state.refused !== refusedBefore) refuse({ code: "panel", detail: state.refused });
  refusedBefore = state.refused ?? "";
  if (Date.now() > noticeUntil) {
    element("notice").textContent = state.message;
    element("notice").hidden = !state.message;
  }
  window.dispatchEvent(new CustomEvent("station-bar", { detail: state }));
}

// A failed STOP is forgotten when its way is open again: the dashboard has answered a
// request, and it hears the station.
function forgetFailedStop({ link, stop_state }) {
  const isWell = link === "live" && (stop_state === "stopped" || Date.now() - stopFailedAt > NOT_STOPPED_MS);
  if (stopFailedAt && isWell) stopFailedAt = noticeUntil = 0;
}

async function refresh() {
  const asked = performance.now();
  try {
    const answer = await patiently("/state", PATIENCE_MS);
    if (answer.status === 401) return location.replace("/login");
    const state = await answer.json();
    forgetFailedStop(state);
    if (asked > backAt || state.link === "live") render(state);
  } catch {
    element("bar").dataset.link = "lost";
    show("link", "dashboard not answering");
    window.dispatchEvent(new CustomEvent("station-bar", { detail: { link: "lost" } }));
  }
}

// The docks were told that the station is back. What was asked before is out of date.
let backAt = 0;
window.addEventListener("station-back", () => {
  backAt = performance.now();
  if (latest) render({ ...latest, link: "live", age: 0 });
  refresh();
});

async function poll() {
  // Again and again, because Viser's page replaces its document while it loads; adding
  // the same listener twice changes nothing.
  for (const target of [window, element("view").contentWindow])
    for (const name of ["keydown", "keyup"]) target.addEventListener(name, onKey, true);
  await refresh();
  setTimeout(poll, element("bar").dataset.link === "live" ? POLL_MS : POLL_LOST_MS);
}

const TEXTS = 'textarea, input:is(:not([type]), [type=""], [type="text"], [type="search"], [type="password"], [type="number"])';
const isTyping = (target) => Boolean(target?.isContentEditable || target?.matches?.(TEXTS));

// Space is a letter of a text; Escape stops while a field has the focus, too, whatever else
// it would do there. Both the press and the release are swallowed: Space would click a
// focused button.
function onKey(event) {
  const stops = event.key === "Escape" || (event.key === " " && !isTyping(event.target));
  if (!stops) return;
  event.preventDefault();
  event.stopPropagation();
  if (event.type === "keydown" && !event.repeat) stop();
}

// The docks are one script with many parts: when one of them does not load, none works.
// Scripts that the page waits for have run by then.
document.addEventListener("DOMContentLoaded", () => {
  if (document.body.dataset.docks) return;
  element("unloaded").firstElementChild.textContent = "A part of this page did not load: its docks are missing. STOP works.";
  element("unloaded").classList.add("now");
});

window.addEventListener("station-act", (event) => act(event.detail));
element("logout").addEventListener("click", async () => {
  await fetch("/logout", { method: "POST", redirect: "manual" });
  location.replace("/login");
});
element("stop").addEventListener("click", stop);
element("release").addEventListener("click", () => act("/release"));
element("arm").addEventListener("click", () => act("/arm"));
document.body.dataset.strip = "ready";
poll();
