// Four steps for somebody who sees the page for the first time; gone after a click.
import { isNarrow, kept } from "./dom.js";

export function showTour(card, openDock) {
  if (kept.get("tour", "") === "done") return;
  const steps = [...card.querySelectorAll("p")];
  const [skip, next] = card.querySelectorAll("button");
  let at = -1;
  const show = (isOver) => {
    document.querySelector(".toured")?.classList.remove("toured");
    if (isOver) kept.set("tour", "done");
    card.hidden = isOver;
    at += 1;
    if (isOver) return;
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
