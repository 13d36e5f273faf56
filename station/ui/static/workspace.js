// The workspace: where the docks are, their sizes and folds, and what the strip's log,
// the first minute and the progress line show. Each panel is a file in `panels/`.
import { watchAgents } from "./lib/agents.js";
import { alarms } from "./lib/alarms.js";
import { control } from "./lib/control.js";
import { act, enableSliders, html, isNarrow, kept, nothing, number, press, refusals, remedyOf, render, repeat, show, stopController, store, switchTo, teleoperation, units } from "./lib/panel.js";
import { layoutNames, layoutPath } from "./lib/plot_layouts.js";
import { showViewTools, watchScene } from "./lib/view_tools.js";
import "./panels/joints.js";
import "./panels/controllers.js";
import "./panels/gripper.js";
import "./panels/move.js";
import "./panels/tuning.js";
import "./panels/plots.js";
import "./panels/timeline.js";
import "./panels/simulation.js";
import "./panels/lessons.js";
import "./panels/cameras.js";

// Which docks each layout opens, which it opens as well beside them in a second column, and the height of those below.
const PRESETS = {
  Operate: { open: ["joints", "controllers", "gripper", "plots", "timeline"], wide: ["move", "tuning"], below: 236 },
  Tune: { open: ["joints", "tuning", "plots"], wide: ["controllers"], below: 300 },
  Record: { open: ["joints", "move", "plots", "timeline"], wide: ["gripper", "tuning"], below: 300 },
  Safety: { open: ["joints", "controllers", "timeline", "simulation"], wide: ["gripper", "move"], below: 300 },
};
const TWO_COLUMNS = 1600; // as in the style sheet [px]
const SHRUNK = 200; // a dock may be made so low for another one [px]

const element = (id) => document.getElementById(id);
const columns = () => (innerWidth >= TWO_COLUMNS ? 2 : 1);
const sections = new Map([...document.querySelectorAll(".dock")].map((section) => [section.dataset.dock, section]));
const ids = [...sections.keys()];
const usedAt = new Map(ids.map((id, i) => [id, -i])); // when a dock was used last

/** What a layout folds here: without a second column fewer docks are open. */
function arranged({ open, wide = [], ...sizes }) {
  const shown = columns() > 1 ? [...open, ...wide] : open;
  return { ...sizes, folded: Object.fromEntries(ids.map((id) => [id, !shown.includes(id)])) };
}

const layout = { side: 468, dock: "joints", heights: {}, preset: "Operate", ...kept.get("layout", arranged(PRESETS.Operate)) };

const keepLayout = () => kept.set("layout", layout);

function applySizes() {
  const workspace = element("workspace");
  const side = Math.min(Math.max(layout.side, 300), (innerWidth - 320) / columns()) * columns();
  const below = Math.min(Math.max(layout.below, 90), innerHeight - 260);
  workspace.style.setProperty("--side", `${side}px`);
  workspace.style.setProperty("--below", `${below}px`);
  element("split-side").ariaValueNow = Math.round(side);
  element("split-below").ariaValueNow = Math.round(below);
}

let own = []; // names of the layouts that the station keeps
let layoutsOf = ""; // the station that they are of

async function listLayouts() {
  own = (await layoutNames()) ?? own;
  drawLayouts();
}

/** Return a layout of the station as this page has it; its plots are shown. */
async function fetchLayout(name) {
  const answer = await act("GET", layoutPath(name));
  if (answer?.plots.length) element("dock-plots").showSettings(answer.plots);
  if (!answer?.docks) return answer && {};
  const { folded, side, below, heights } = answer.docks;
  return { side, below, folded: Object.fromEntries(ids.map((id) => [id, folded.includes(id)])), heights: Object.fromEntries(Object.entries(heights).map(([id, size]) => [id, `${size}px`])) };
}

/** The layouts of the station's makers, and those that somebody has kept at the station. */
function drawLayouts() {
  const choose = async (name) => {
    const chosen = name in PRESETS ? arranged(PRESETS[name]) : await fetchLayout(name);
    if (!chosen) return;
    Object.assign(layout, { heights: {} }, chosen, { preset: name });
    for (const [id, section] of sections) section.dispatchEvent(new CustomEvent("fold", { detail: Boolean(layout.folded[id]) }));
    layout.preset = name;
    applySizes();
    keepLayout();
    drawLayouts();
  };
  const keep = async ({ key, target }) => {
    const name = target.value.trim().replace(/\s+/g, "-");
    if (key !== "Enter" || !name || name in PRESETS) return;
    const heights = Object.entries(layout.heights).map(([id, size]) => [id, parseFloat(size)]);
    const docks = { side: layout.side, below: layout.below, folded: ids.filter((id) => layout.folded[id]), heights: Object.fromEntries(heights.filter(([, size]) => size > 0)) };
    if (!(await act("PUT", layoutPath(name), { plots: element("dock-plots").settings(), docks }))) return;
    target.value = "";
    layout.preset = name;
    listLayouts();
  };
  const forget = async () => (await act("DELETE", layoutPath(layout.preset))) && listLayouts();
  const button = (name) => press(name, "", () => choose(name), { pressed: name === layout.preset });
  const remove = own.includes(layout.preset) ? press("✕", "", forget, { needs: "change", name: `Forget the layout ${layout.preset}` }) : nothing;
  render(html`${repeat([...Object.keys(PRESETS), ...own], (name) => name, button)}${remove}<input class="name" placeholder="keep as …" aria-label="Keep this layout as" title="A name and Enter keep folds, sizes and plots at the station, for every browser." ?disabled=${!store.can("change")} @keydown=${keep} />`, element("layouts"));
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

function wireDock(section, id) {
  const { firstElementChild: head, lastElementChild: body } = section;
  const fold = head.querySelector(".fold");
  const setFolded = (folded) => {
    layout.folded[id] = folded;
    section.classList.toggle("folded", folded);
    fold.ariaExpanded = !folded;
    if (body.isShown && store.docks) body.refresh(); // not at the next poll
  };
  const change = (folded) => {
    setFolded(folded);
    if (!folded) makeRoom(section);
    layout.preset = "";
    drawLayouts();
    keepLayout();
  };
  const arrange = (folded) => {
    setFolded(folded);
    section.style.height = layout.heights[id] ?? "";
  };
  fold.addEventListener("click", () => change(!layout.folded[id]));
  section.addEventListener("fold", ({ detail }) => arrange(detail));
  section.addEventListener("open-dock", () => layout.folded[id] && change(false));
  for (const name of ["pointerdown", "focusin"]) section.addEventListener(name, () => usedAt.set(id, performance.now()));
  arrange(Boolean(layout.folded[id]));
  new MutationObserver(() => {
    layout.heights[id] = section.style.height;
    keepLayout();
  }).observe(section, { attributes: true, attributeFilter: ["style"] });
}

/** Fold what was used longest ago in the column of a dock that was opened, until each open one has room. */
function makeRoom(section) {
  const column = columns() > 1 ? section.parentElement : element("side");
  if (!column.contains(section) || isNarrow()) return;
  const needed = ({ firstElementChild: head, lastElementChild: body }) => head.offsetHeight + Math.min(body.scrollHeight, SHRUNK);
  const docks = [...column.querySelectorAll(".dock")].filter(({ hidden }) => !hidden);
  const others = docks.filter((one) => one !== section && !one.classList.contains("folded") && needed(one) >= SHRUNK);
  // The joints go with whatever else is done, so they stay longest.
  const rank = ({ dataset: { dock } }) => (dock === "joints" ? Infinity : usedAt.get(dock));
  others.sort((a, b) => rank(a) - rank(b));
  const room = element("side").clientHeight - element("layouts").offsetHeight;
  while (others.length && docks.reduce((sum, one) => sum + needed(one) + 6, 0) > room)
    others.shift().dispatchEvent(new CustomEvent("fold", { detail: true }));
}

/** Unfold a dock, which a narrow screen shows alone. */
function chooseDock(id) {
  layout.dock = id;
  sections.get(id).dispatchEvent(new Event("open-dock"));
  showChosen();
}

function showChosen() {
  for (const button of element("docks-nav").children) button.ariaPressed = button.dataset.dock === layout.dock;
  for (const [id, section] of sections) section.classList.toggle("chosen", id === layout.dock);
}

// A real robot has nothing to simulate, and only Franka arms have a gripper that a page
// can move: a page has no dock of what its station lacks.
function showDocks() {
  const { boot_id: known, simulation, arms } = store.docks;
  const lacks = { simulation: !simulation, gripper: !arms.length, cameras: !element("dock-cameras").cameras.length };
  for (const [id, isLacking] of Object.entries(lacks)) {
    const absent = Boolean(known) && isLacking;
    for (const part of document.querySelectorAll(`[data-dock="${id}"]`)) part.hidden = absent;
    if (!absent || layout.dock !== id) continue;
    layout.dock = "joints";
    showChosen();
  }
}

/** Unfold a dock and bring it into view. */
function openDock(id) {
  chooseDock(id);
  sections.get(id).scrollIntoView({ block: "nearest" });
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
  const help = action && store.isOperator ? press(label, "", recover, { look: "s primary", needs: "change" }) : nothing;
  render(html`<b>✖ ${trouble}</b><span>${reason}</span>${help}`, line);
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

function logRow(entry) {
  const time = new Date(entry.at).toLocaleTimeString("en-GB");
  const count = entry.count > 1 ? ` (${entry.count} times)` : "";
  const words = entry.remedy ? html`<span class="remedy">${units.words(entry.remedy)}</span>` : nothing;
  const remedy = remedyOf(entry, { stop: store.stop, ...store.docks }, remedies);
  const button = remedy && store.isOperator ? press(remedy.label, "", remedy.run, { look: "s primary" }) : nothing;
  return html`<div class="row"><time>${time}</time><span class="cause">▲ ${units.words(entry.detail)}${count}</span>${words}${button}</div>`;
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
  button.disabled = Boolean(enabling?.reason) || !store.can("change");
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

/** Four steps for somebody who sees the page for the first time; gone after a click. */
function showTour(card) {
  if (kept.get("tour", "") === "done") return;
  const steps = [...card.querySelectorAll("p")];
  const [skip, next] = card.querySelectorAll("button");
  let at = -1;
  const show = (isOver) => {
    document.querySelector(".toured")?.classList.remove("toured");
    card.hidden = isOver;
    if (isOver) return kept.set("tour", "done");
    at += 1;
    const { mark, opens } = steps[at].dataset;
    if (opens && isNarrow()) openDock(opens);
    document.querySelector(mark)?.classList.add("toured");
    steps.forEach((step, i) => (step.hidden = i !== at));
    card.querySelector("b").textContent = `${at + 1} of ${steps.length}`;
    skip.hidden = at === steps.length - 1;
    if (skip.hidden) next.textContent = "Done";
  };
  skip.addEventListener("click", () => show(true));
  next.addEventListener("click", () => show(skip.hidden));
  show(false);
}

function start() {
  for (const [id, section] of sections) wireDock(section, id);
  // On a narrow screen one dock is shown at a time; these buttons choose it.
  for (const button of element("docks-nav").children) button.addEventListener("click", () => chooseDock(button.dataset.dock));
  showChosen();
  drawLayouts();
  applySizes();
  addEventListener("resize", applySizes);
  splitter("split-side", "side", (event) => -event.movementX / columns());
  splitter("split-below", "below", (event) => -event.movementY);
  window.addEventListener("station-bar", (event) => {
    const before = store.bar.role;
    Object.assign(store.bar, event.detail);
    document.body.dataset.role = store.bar.role;
    if (store.isOperator && before !== store.bar.role) teleoperation.connect();
    store.dispatchEvent(new Event("bar"));
  });
  element("log-button").addEventListener("click", ({ currentTarget }) => {
    currentTarget.ariaExpanded = element("log").hidden;
    element("log").hidden = !element("log").hidden;
    showLog();
  });
  refusals.addEventListener("change", showRefusal);
  units.addEventListener("change", showLog);
  element("enable").addEventListener("click", enableSliders);
  store.addEventListener("bar", drawLayouts);
  store.addEventListener("docks", () => {
    showEnable();
    showTrouble();
    showDocks();
    if (store.docks.link !== "live" || layoutsOf === store.bootId) return;
    layoutsOf = store.bootId;
    listLayouts();
  });
  store.start();
  setInterval(showAge, 100);
  store.addEventListener("joints", () => document.body.classList.contains("stale") && showAge());
  control.start();
  watchAgents();
  alarms.start(element("alarms"), () => {
    openDock("timeline");
    element("dock-timeline").choose("alarms");
  });
  window.addEventListener("show-dock", ({ detail }) => openDock(detail));
  watchScene(element("view"), element("progress"), () => store.docks);
  showViewTools(element("view-tools"));
  showTour(element("tour"));
  // The docks are there; the strip with its STOP may not be.
  document.body.dataset.docks = "ready";
  element("unloaded").hidden = document.body.dataset.strip === "ready";
  element("unloaded").classList.add("now");
}

start();
