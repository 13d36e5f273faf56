// The workspace: where the docks are, their sizes and folds, and what the strip's log,
// the first minute and the progress line show. Each panel is a file in `panels/`.
import { alarms } from "./lib/alarms.js";
import { h, kept, show } from "./lib/dom.js";
import { control } from "./lib/control.js";
import { refusals, remedyOf } from "./lib/refusals.js";
import { act, teleoperation } from "./lib/station.js";
import { enableSliders, stopController, store, switchTo } from "./lib/store.js";
import { number } from "./lib/text.js";
import { showTour } from "./lib/tour.js";
import { watchScene } from "./lib/scene.js";
import { showViewTools } from "./lib/view_tools.js";
import { html, nothing, render } from "./vendor/lit/lit-html.js";
import { repeat } from "./vendor/lit/directives/repeat.js";
import "./panels/joints.js";
import "./panels/controllers.js";
import "./panels/gripper.js";
import "./panels/move.js";
import "./panels/tuning.js";
import "./panels/plots.js";
import "./panels/timeline.js";
import "./panels/simulation.js";
import "./panels/lessons.js";

const DOCKS = [
  { id: "joints", title: "Joints", place: "side" },
  { id: "controllers", title: "Controllers", place: "side" },
  { id: "gripper", title: "Gripper", place: "side" },
  { id: "move", title: "Waypoints and moves", place: "side" },
  { id: "tuning", title: "Tuning", place: "side" },
  { id: "lessons", title: "Lessons", place: "side" },
  { id: "plots", title: "Plots", place: "below" },
  { id: "timeline", title: "Timeline", place: "below" },
  { id: "simulation", title: "Simulation", place: "below" },
];
const FOLDED_AT_FIRST = { move: true, tuning: true, lessons: true, simulation: true };

const element = (id) => document.getElementById(id);
const layout = kept.get("layout", { side: 468, below: 236, folded: FOLDED_AT_FIRST, dock: "joints", heights: {} });

function keepLayout() {
  kept.set("layout", layout);
}

function applySizes() {
  const workspace = element("workspace");
  const side = Math.min(Math.max(layout.side, 300), innerWidth - 320);
  const below = Math.min(Math.max(layout.below, 90), innerHeight - 260);
  workspace.style.setProperty("--side", `${side}px`);
  workspace.style.setProperty("--below", `${below}px`);
  element("split-side").setAttribute("aria-valuenow", String(Math.round(side)));
  element("split-below").setAttribute("aria-valuenow", String(Math.round(below)));
}

function splitter(id, key, grow) {
  const handle = element(id);
  const change = (by) => {
    layout[key] += by;
    applySizes();
    keepLayout();
  };
  handle.addEventListener("pointerdown", (event) => {
    handle.setPointerCapture(event.pointerId);
    document.body.classList.add("resizing");
  });
  handle.addEventListener("pointermove", (event) => {
    if (handle.hasPointerCapture(event.pointerId)) change(grow(event));
  });
  handle.addEventListener("lostpointercapture", () => document.body.classList.remove("resizing"));
  handle.addEventListener("keydown", (event) => {
    const steps = { ArrowLeft: 16, ArrowUp: 16, ArrowRight: -16, ArrowDown: -16 };
    if (event.key in steps) change(steps[event.key]);
  });
}

function makeDock(dock) {
  const body = document.createElement(`st-${dock.id}`);
  body.id = `dock-${dock.id}`;
  const fold = h("button", { class: "fold", type: "button" }, h("span", { class: "arrow", ariaHidden: "true" }), dock.title);
  fold.setAttribute("aria-controls", body.id);
  const tools = h("span", { class: "tools" });
  const section = h(
    "section",
    { class: "dock", data: { dock: dock.id } },
    h("h2", {}, fold, tools),
    body,
  );
  body.tools = tools;
  const setFolded = (folded) => {
    layout.folded[dock.id] = folded;
    section.classList.toggle("folded", folded);
    fold.setAttribute("aria-expanded", String(!folded));
    keepLayout();
    if (body.built && body.isShown && store.docks) body.refresh(); // not at the next poll
  };
  fold.addEventListener("click", () => setFolded(!layout.folded[dock.id]));
  setFolded(Boolean(layout.folded[dock.id]));
  section.addEventListener("open-dock", () => setFolded(false));
  if (layout.heights[dock.id]) section.style.height = layout.heights[dock.id];
  new MutationObserver(() => {
    layout.heights[dock.id] = section.style.height;
    keepLayout();
  }).observe(section, { attributes: true, attributeFilter: ["style"] });
  element(dock.place).append(section);
}

// On a narrow screen one dock is shown at a time; these buttons choose it.
function makeNav() {
  for (const dock of DOCKS) {
    const button = h("button", { class: "s", type: "button" }, dock.title);
    button.addEventListener("click", () => {
      layout.dock = dock.id;
      document.querySelector(`.dock[data-dock="${dock.id}"]`).dispatchEvent(new Event("open-dock"));
      chooseDock();
    });
    button.dataset.dock = dock.id;
    element("docks-nav").append(button);
  }
  chooseDock();
}

function chooseDock() {
  for (const button of element("docks-nav").children)
    button.setAttribute("aria-pressed", String(button.dataset.dock === layout.dock));
  for (const section of document.querySelectorAll(".dock"))
    section.classList.toggle("chosen", section.dataset.dock === layout.dock);
}

// A real robot has nothing to simulate, and only Franka arms have a gripper that a page
// can move: a page has no dock of what its station lacks.
function showDocks() {
  const { boot_id: known, simulation, arms } = store.docks;
  const lacks = { simulation: !simulation, gripper: !arms.length };
  for (const [id, isLacking] of Object.entries(lacks)) {
    const absent = Boolean(known) && isLacking;
    for (const part of document.querySelectorAll(`[data-dock="${id}"]`)) part.hidden = absent;
    if (!absent || layout.dock !== id) continue;
    layout.dock = "joints";
    chooseDock();
  }
}

/** Unfold a dock and bring it into view. */
export function openDock(id) {
  layout.dock = id;
  const section = document.querySelector(`.dock[data-dock="${id}"]`);
  section.dispatchEvent(new Event("open-dock"));
  chooseDock();
  section.scrollIntoView({ block: "nearest" });
}

// An arm that stopped itself says so in a line of its own, with the button that helps.
async function recover() {
  const { action, arms } = store.docks.rescue;
  if (action === "release")
    for (const arm of arms) await act("POST", `/robots/${arm}/user_stop`, { pressed: false });
  await act("POST", "/robots/error_recovery");
  await store.refresh();
}

function showTrouble() {
  const { trouble, reason, label, action } = store.docks.rescue;
  const line = element("trouble");
  line.hidden = !trouble;
  const button = action && store.isOperator ? html`<button class="s primary" type="button" @click=${recover}>${label}</button>` : nothing;
  render(html`<b>✖ ${trouble}</b><span>${reason}</span>${button}`, line);
}

const remedies = {
  release: () => window.dispatchEvent(new CustomEvent("station-act", { detail: "/release" })),
  arm: () => window.dispatchEvent(new CustomEvent("station-act", { detail: "/arm" })),
  recover,
  enable: enableSliders,
  takeControl: () => control.open({ asking: true }),
  switchTo,
  stopController,
};

function remedyButton(entry) {
  const remedy = remedyOf(entry, { stop: store.stop, ...store.docks }, remedies);
  return remedy && store.isOperator ? html`<button class="s primary" type="button" @click=${remedy.run}>${remedy.label}</button>` : nothing;
}

function logRow(entry) {
  const time = new Date(entry.at).toLocaleTimeString("en-GB");
  const count = entry.count > 1 ? ` (${entry.count} times)` : "";
  const remedy = entry.remedy ? html`<span class="remedy">${entry.remedy}</span>` : nothing;
  return html`<div class="row"><time>${time}</time><span class="cause">▲ ${entry.detail}${count}</span>${remedy}${remedyButton(entry)}</div>`;
}

function showLog() {
  show(element("log-count"), String(refusals.entries.length));
  const rows = repeat(refusals.entries, (entry) => entry, logRow);
  const empty = html`<p class="hint">Nothing was refused since this page was opened.</p>`;
  render(html`<h2>Refusals</h2>${refusals.entries.length ? rows : empty}`, element("log"));
}

let lineTimer = null;
function showRefusal() {
  showLog();
  const line = element("refusal-line");
  const hide = () => (line.hidden = true);
  render(html`${logRow(refusals.entries[0])}<button class="s" type="button" title="Hide; it stays in the log." @click=${hide}>Hide</button>`, line);
  line.hidden = false;
  clearTimeout(lineTimer);
  lineTimer = setTimeout(hide, 20000);
}

function showEnable() {
  const enabling = store.docks?.enabling;
  const wanted = Boolean(enabling?.name) && store.isOperator;
  const button = element("enable");
  button.hidden = !wanted;
  button.disabled = Boolean(enabling?.reason);
  // While another controller moves the robot, the picture matters more than the offer.
  button.classList.toggle("small", Boolean(enabling?.replaces?.length));
  const stops = enabling?.replaces?.length ? ` ${enabling.replaces.join(", ")} stops.` : "";
  button.title = enabling?.reason || `Starts ${[enabling?.name, ...(enabling?.also ?? [])].join(" and ")}, so that the joints take values.${stops}`;
}

// While a slow picture of the 3D view is drawn, frames wait to be read: they are heard
// after this look, so that only the next look can tell whether the data is old.
const HELD_UP_MS = 400;
let lookedAt = 0;
function showAge() {
  const now = performance.now();
  const age = store.heardAt ? now - store.heardAt : null;
  const isHeldUp = now - lookedAt > HELD_UP_MS && !document.body.classList.contains("stale");
  lookedAt = now;
  if (isHeldUp && age !== null) return;
  const text = age === null ? "–" : age < 1000 ? `${number(age, 0)} ms` : `${number(age / 1000, 1)} s`;
  show(element("age"), text);
  document.body.classList.toggle("stale", age === null || age > 700);
}

function start() {
  for (const dock of DOCKS) makeDock(dock);
  makeNav();
  applySizes();
  addEventListener("resize", applySizes);
  splitter("split-side", "side", (event) => -event.movementX);
  splitter("split-below", "below", (event) => -event.movementY);
  window.addEventListener("station-bar", (event) => {
    const before = store.bar.role;
    store.bar = { ...store.bar, ...event.detail };
    document.body.dataset.role = store.bar.role;
    if (store.isOperator && before !== store.bar.role) teleoperation.connect();
    store.dispatchEvent(new Event("bar"));
  });
  element("log-button").addEventListener("click", () => {
    const log = element("log");
    log.hidden = !log.hidden;
    element("log-button").setAttribute("aria-expanded", String(!log.hidden));
    showLog();
  });
  refusals.addEventListener("change", showRefusal);
  element("enable").addEventListener("click", enableSliders);
  store.addEventListener("docks", showEnable);
  store.addEventListener("docks", showTrouble);
  store.addEventListener("docks", showDocks);
  store.start();
  setInterval(showAge, 100);
  store.addEventListener("joints", () => document.body.classList.contains("stale") && showAge());
  control.start();
  alarms.start(element("alarms"), () => {
    openDock("timeline");
    element("dock-timeline").choose("alarms");
  });
  watchScene(element("view"), element("progress"), () => store.docks);
  showViewTools(element("view-tools"));
  showTour(element("tour"), openDock);
  showLoaded();
}

/** Say that the docks are there, or that the strip with its STOP is not. */
function showLoaded() {
  document.body.dataset.docks = "ready";
  element("unloaded").hidden = document.body.dataset.strip === "ready";
  element("unloaded").classList.add("now");
}

start();
