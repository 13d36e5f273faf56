// The progress line over the 3D view, and the notice of Viser that would cover it.
import { isNarrow, show } from "./dom.js";

const LOOK_MS = 250;
const LONG_MS = 15000;
const SETTLED_LOOKS = 40; // what is out of sight is not drawn, and not waited for

/** Say what of the 3D view is still loading until all triangles of the robots are drawn, or why they are not. */
export function watchScene(view, line, docks) {
  const began = Date.now();
  let drawn = 0; // the most triangles of a picture; some show the background alone
  let same = 0;
  const look = () => {
    const inside = view.contentWindow;
    foldNotice(inside.document);
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
