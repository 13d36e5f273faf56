// What lies over the 3D view: the toolbar, from where to look and what to lay over the robots,
// the progress line, and the notice of Viser that would cover the picture. The choice of the
// toolbar is this browser's; the gateway draws it in the views of this session alone.
import { act, choice, h, holdButton, html, isNarrow, kept, nothing, offer, press, refusals, render, send, show, store, typed } from "./panel.js";

const LOOK_MS = 250;
const LONG_MS = 15000;
const SETTLED_LOOKS = 40; // what is out of sight is not drawn, and not waited for
const AT_FIRST = ["command", "forces", "limits"];

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
    return html`<div class="tools-group" role="group" aria-label="Push"><span aria-hidden="true">Push</span><span class="hint">Pull a link with the pointer, or hold:</span>${arm}${buttons}${force}N</div>`;
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
  const folder = place.querySelector("details");
  const layers = [...place.querySelectorAll("[data-layer]")];
  folder.open = kept.get("view-tools", !isNarrow());
  folder.addEventListener("toggle", () => kept.set("view-tools", folder.open));
  for (const button of layers) button.addEventListener("click", () => toggle(button.dataset.layer));
  for (const button of place.querySelectorAll("[data-camera]"))
    button.addEventListener("click", () => quietly("POST", "/ui/camera", { preset: button.dataset.camera, covered: covered(place) }));
  const draw = () => {
    for (const button of layers) button.ariaPressed = shown.includes(button.dataset.layer);
    for (const sign of place.querySelectorAll(".key li")) sign.hidden = !shown.includes(sign.dataset.of);
    // Only a Franka arm says what pushes it.
    place.querySelector(".force").parentElement.hidden ||= !store.docks?.arms.length;
    const without = store.isOperator ? PULL : "This session only watches. An operator's session can push.";
    const title = simulated().length ? without : "Only a simulated Franka arm can be pushed.";
    const push = press("Push", title, togglePush, { pressed: beating !== null, needs: "change", off: () => !simulated().length });
    render(html`<span aria-hidden="true">Act</span>${push}${beating ? pushing() : nothing}`, place.querySelector("[aria-label=Act]"));
  };
  draw();
  store.addEventListener("docks", draw);
  const system = matchMedia("(prefers-color-scheme: dark)");
  const paint = () => quietly("PUT", "/ui/scheme", { dark: system.matches });
  system.addEventListener("change", paint);
  // A dashboard that was started anew knows no choice any more.
  let link = "";
  window.addEventListener("station-bar", (event) => {
    if (event.detail.link === "live" && link !== "live") {
      tell();
      paint();
      quietly("POST", "/ui/opened", { covered: covered(place) });
    }
    link = event.detail.link;
  });
}

/** Say what of the 3D view is still loading until all triangles of the robots are drawn, or why they are not. */
export function watchScene(view, line, docks) {
  const began = Date.now();
  let drawn = 0; // the most triangles of a picture; some show the background alone
  let same = 0;
  const look = () => {
    const inside = view.contentWindow;
    const now = inside.__viserTestpoints?.rendererInfo?.render?.triangles ?? 0;
    const { triangles: wanted = null, not_drawn: missing } = docks() ?? {};
    if (missing) return show(line, `There is no picture. ${missing}`);
    same = drawn > 0 && now <= drawn ? same + 1 : 0;
    drawn = Math.max(drawn, now);
    if (drawn > 0 && wanted !== null && (drawn >= wanted || same > SETTLED_LOOKS)) return void (line.hidden = true);
    const late = Date.now() - began > LONG_MS ? ` This takes long; everything else works already.${inside.__viserTestpoints ? "" : " Reload the page if it stays so."}` : "";
    const count = `${drawn.toLocaleString("en")}${wanted ? ` of ${wanted.toLocaleString("en")}` : ""}`;
    const connected = drawn ? `3D view: loading the robots (${count} triangles) …` : "3D view: connecting …";
    const step = inside.__viserTestpoints ? connected : "Loading the 3D view …";
    show(line, step + late);
    return setTimeout(look, LOOK_MS);
  };
  look();
  const button = document.getElementById("viser-panel");
  button.addEventListener("click", () => {
    button.ariaPressed = button.ariaPressed !== "true";
    showPanel(view, button);
  });
  setInterval(() => {
    foldNotice(view.contentWindow.document);
    showPanel(view, button);
  }, 500);
}

// On a narrow screen Viser lays its panel over the picture and cannot be told to fold it.
function showPanel(view, button) {
  const isHidden = isNarrow() && button.ariaPressed !== "true";
  for (const panel of view.contentWindow.document.querySelectorAll("#root .mantine-Paper-root:has([role=tab])")) panel.style.visibility = isHidden ? "hidden" : "";
}

// Viser says in a card over the picture that no GPU is used. That is worth knowing and
// not worth the picture, so the card is closed and its words go into the view's title.
function foldNotice(page) {
  for (const card of page.querySelectorAll(".mantine-Notification-root")) {
    if (!card.textContent.includes("Software WebGL")) continue;
    card.querySelector("button")?.click();
    document.getElementById("view").title = "Robot and controls. Drawn in software, without a GPU.";
  }
}
