// Four steps for somebody who sees the page for the first time; gone after a click.
import { html, isNarrow, kept, nothing, press, render } from "./dom.js";

const STEPS = [
  { mark: "#stop", text: "STOP, Escape or Space stops the robot at any time, from every dock. Afterwards: Release stop, then Allow motion." },
  { mark: "#enable", text: "“Enable sliders” starts a controller that takes joint values. Until then the arm holds its pose." },
  { mark: "[data-dock=joints]", dock: "joints", text: "Type a value and press Enter, or hold − and + to move one joint. The top speed is yours to choose." },
  { mark: "[data-dock=plots]", dock: "plots", text: "Everything the station streams can be plotted. Titles fold a dock; the bars between docks resize them; this browser remembers." },
];

export function showTour(card, openDock) {
  if (kept.get("tour", "") === "done") return;
  const unmark = () => document.querySelector(".toured")?.classList.remove("toured");
  const end = () => {
    unmark();
    card.hidden = true;
    kept.set("tour", "done");
  };
  const step = (at) => {
    unmark();
    const { mark, dock, text } = STEPS[at];
    if (dock && isNarrow()) openDock(dock);
    document.querySelector(mark)?.classList.add("toured");
    const isLast = at === STEPS.length - 1;
    const next = press(isLast ? "Done" : "Next", "", () => (isLast ? end() : step(at + 1)), { look: "s primary" });
    render(html`<b>${at + 1} of ${STEPS.length}</b><p>${text}</p><span>${isLast ? nothing : press("Skip the tour", "", end)}${next}</span>`, card);
    card.hidden = false;
  };
  step(0);
}
