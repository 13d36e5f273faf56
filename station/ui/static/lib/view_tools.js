// The toolbar over the 3D view: from where to look, and what to lay over the robots.
// The choice is this browser's; the gateway draws it in the views of this session alone.
import { h, kept } from "./dom.js";
import { send } from "./station.js";

const CAMERAS = [
  ["fit", "Fit", "Show all robots"],
  ["front", "Front", "Look from the front"],
  ["side", "Side", "Look from the side"],
  ["top", "Top", "Look from above"],
  ["hand", "Hand", "Look at the hand from near"],
];
const LAYERS = [
  ["command", "Command", "Where the robot was told to be, while it is somewhere else (blue-green)"],
  ["forces", "Forces", "Forces on the arm and contacts, as red arrows"],
  ["limits", "Limits", "Links whose joint is near a limit, in orange, with the angle that is left"],
  ["trail", "Trail", "Where the hand was"],
  ["frames", "Frames", "Base O, flange F, end effector EE and stiffness frame K"],
  ["collision", "Collision", "The geometry that collides"],
];
const AT_FIRST = ["command", "forces", "limits"];

function button(label, title, run) {
  return h("button", { class: "s", type: "button", title, onclick: run }, label);
}

function group(name, ...children) {
  const made = h("div", { class: "tools-group" }, h("span", { ariaHidden: "true" }, name), ...children);
  made.setAttribute("role", "group");
  made.setAttribute("aria-label", name);
  return made;
}

/** Build the toolbar into `place`. */
export function showViewTools(place) {
  let shown = kept.get("layers", AT_FIRST);
  const tell = () => send("PUT", "/ui/layers", { shown }).catch((error) => console.warn(error.message));
  const cameras = CAMERAS.map(([name, label, title]) =>
    button(label, title, () => send("POST", "/ui/camera", { preset: name }).catch((error) => console.warn(error.message))),
  );
  const layers = LAYERS.map(([name, label, title]) => {
    const made = button(label, title, () => {
      shown = shown.includes(name) ? shown.filter((other) => other !== name) : [...shown, name];
      kept.set("layers", shown);
      made.setAttribute("aria-pressed", String(shown.includes(name)));
      tell();
    });
    made.setAttribute("aria-pressed", String(shown.includes(name)));
    return made;
  });
  const fold = h("summary", { class: "s" }, "View");
  const folder = h("details", {}, fold, h("div", { class: "tools-body" }, group("Camera", ...cameras), group("Show", ...layers)));
  folder.open = kept.get("view-tools", innerWidth > 700);
  folder.addEventListener("toggle", () => kept.set("view-tools", folder.open));
  place.append(folder);
  // A dashboard that was started anew knows no choice any more.
  let link = "";
  window.addEventListener("station-bar", (event) => {
    if (event.detail.link === "live" && link !== "live") tell();
    link = event.detail.link;
  });
}
