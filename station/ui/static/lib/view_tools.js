// The toolbar over the 3D view: from where to look, and what to lay over the robots.
// The choice is this browser's; the gateway draws it in the views of this session alone.
import { choice, h, holdButton, html, isNarrow, kept, nothing, offer, press, render } from "./dom.js";
import { refusals } from "./refusals.js";
import { act, send } from "./station.js";
import { store } from "./store.js";
import { typed } from "./text.js";

const CAMERAS = [
  ["fit", "Fit", "Show all robots."],
  ["front", "Front", "Look from the front."],
  ["side", "Side", "Look from the side."],
  ["top", "Top", "Look from above."],
  ["hand", "Hand", "Look at the hand from near."],
];
// Each with the colours in which it draws: [sign, words]. Only a Franka arm says what pushes it.
const LAYERS = [
  ["command", "Command", "Where the robot was told to be, while it is somewhere else (blue-green).", ["figure", "commanded pose"]],
  ["forces", "Forces", "External force on each arm (red) and where bodies touch (violet).", ["force", "force on the arm"], ["contact", "contact"]],
  ["limits", "Limits", "Links whose joint is near a limit, in orange, with the angle that is left.", ["limit", "joint near its limit"]],
  ["trail", "Trail", "Where the hand was.", ["trail", "path of the flange"]],
  ["frames", "Frames", "Base O, flange F, end effector EE and stiffness frame K.", ["axis-x", "x"], ["axis-y", "y"], ["axis-z", "z axis"]],
  ["collision", "Collision", "The geometry that collides.", ["hull", "collision geometry"]],
];
const OF_FRANKA = ["force"];
const AT_FIRST = ["command", "forces", "limits"];

const group = (name, ...content) => html`<div class="tools-group" role="group" aria-label=${name}><span aria-hidden="true">${name}</span>${content}</div>`;
const quietly = (method, path, body) => send(method, path, body).catch((error) => console.warn(error.message));

const PULL = "Pull the robot with the pointer, in simulation.";
const PUSH_S = 0.3; // one request pushes so long; a held button repeats it sooner
const ALIVE_MS = 100;
const DIRECTIONS = ["x", "y", "z"].flatMap((axis, i) => [-1, 1].map((sign) => [`${sign < 0 ? "−" : "+"}${axis}`, [0, 0, 0].with(i, sign)]));

/** The names of the arms that can be pushed. */
const simulated = () => (store.docks?.simulation ? store.docks.arms.map((one) => one.arm_id) : []);

/** Return the tools that push a simulated arm while a button is held. */
function pushTools() {
  const arm = choice("Arm to push", []);
  const force = h("input", { class: "value", value: "15", inputMode: "decimal", ariaLabel: "Force of the push [N]" });
  const push = (direction) => {
    const size = typed(force.value);
    if (size === null || size < 0 || size > 100) return refusals.add({ code: "not_a_force", detail: `“${force.value}” is not a force.`, remedy: "Type 0 to 100 N." });
    const body = { link: `${arm.value}_hand`, force: direction.map((part) => part * size), duration: PUSH_S };
    return act("POST", `/robots/${arm.value}/external_force`, body);
  };
  const buttons = DIRECTIONS.map(([label, direction]) => holdButton(label, `Push the hand along ${label} while held`, () => push(direction), () => {}));
  return () => {
    offer(arm, simulated(), "no arm");
    arm.hidden = simulated().length < 2;
    return group("Push", html`<span class="hint">Pull a link with the pointer, or hold:</span>`, arm, buttons, force, "N");
  };
}

// The part of the picture that this toolbar covers. On a narrow screen it leaves so little
// that the robots are fitted into the whole picture, to be seen once it is folded.
function covered(place) {
  const body = place.querySelector("details[open] .tools-body")?.getBoundingClientRect();
  const view = document.getElementById("view").getBoundingClientRect();
  const part = body ? (body.right - view.left) / view.width : 0;
  return part < 0.5 ? Math.max(part, 0) : 0;
}

/** Build the toolbar into `place`. */
export function showViewTools(place) {
  let shown = kept.get("layers", AT_FIRST);
  let beating = null; // while links can be pulled
  const tell = () => {
    draw();
    quietly("PUT", "/ui/layers", { shown: beating ? [...shown, "push"] : shown });
  };
  const toggle = (name) => {
    shown = shown.includes(name) ? shown.filter((other) => other !== name) : [...shown, name];
    kept.set("layers", shown);
    tell();
  };
  const togglePush = () => {
    clearInterval(beating);
    // The push goes on only while this page says that it lives.
    beating = beating ? null : setInterval(() => send("POST", "/ui/alive").catch(() => {}), ALIVE_MS);
    tell();
  };
  const pushing = pushTools();
  const folder = place.appendChild(h("details", { open: kept.get("view-tools", !isNarrow()), ontoggle: () => kept.set("view-tools", folder.open) }));
  const camera = ([preset, label, title]) => press(label, title, () => quietly("POST", "/ui/camera", { preset, covered: covered(place) }));
  const isThere = ([sign]) => store.docks?.arms.length || !OF_FRANKA.includes(sign);
  const draw = () => {
    const signs = LAYERS.filter(([layer]) => shown.includes(layer)).flatMap(([, , , ...all]) => all.filter(isThere));
    const without = store.isOperator ? PULL : "This session only watches. An operator's session can push.";
    const title = simulated().length ? without : "Only a simulated Franka arm can be pushed.";
    render(html`<summary class="s">View</summary><div class="tools-body">
      ${group("Camera", CAMERAS.map(camera))}${group("Show", LAYERS.map(([name, label, words]) => press(label, words, () => toggle(name), { pressed: shown.includes(name) })))}
      <ul class="key" aria-label="What the colours mean">${signs.map(([sign, words]) => html`<li><i class=${sign} aria-hidden="true"></i>${words}</li>`)}</ul>
      ${group("Act", press("Push", title, togglePush, { pressed: beating !== null, needs: "change", off: () => !simulated().length }))}${beating ? pushing() : nothing}</div>`, folder);
  };
  draw();
  store.addEventListener("docks", draw);
  const system = matchMedia("(prefers-color-scheme: dark)");
  const paint = () => quietly("PUT", "/ui/scheme", { dark: system.matches });
  system.addEventListener("change", paint);
  const opened = () => quietly("POST", "/ui/opened", { covered: covered(place) });
  // A dashboard that was started anew knows no choice any more.
  let link = "";
  window.addEventListener("station-bar", (event) => {
    if (event.detail.link === "live" && link !== "live") {
      tell();
      paint();
      opened();
    }
    link = event.detail.link;
  });
}
