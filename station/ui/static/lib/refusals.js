// The log of refusals: what was refused, why, what to do, and a button that does it.

const ROUTE = "(?:GET|POST|PUT|PATCH|DELETE) /";
const ASIDE = new RegExp(`\\s*\\(${ROUTE}[^)]*\\)|:\\s*${ROUTE}\\S*(?=\\.$)`, "g");
const ABOUT_ROUTES = new RegExp(ROUTE);

/** Return a remedy without routes of the API: who reads it here has the page. */
export function forPerson(remedy) {
  return remedy
    .split(/(?<=[.!?])\s+(?=[A-Z])/)
    .map((sentence) => sentence.replace(ASIDE, ""))
    .filter((sentence) => !ABOUT_ROUTES.test(sentence))
    .join(" ");
}

class Refusals extends EventTarget {
  entries = [];

  /** Note a refusal. `request` is what was asked for, to offer it again. */
  add(error, request = {}) {
    // The station's words are for scripts; here is a button.
    const own = error.code === "control_held" && error.status ? "Ask for a hand-over, or take control. STOP always works." : error.remedy;
    const last = this.entries[0];
    if (last && last.detail === error.detail && Date.now() - last.at < 3000) {
      last.count += 1;
      last.at = Date.now();
    } else {
      const remedy = [own, ...(error.errors ?? []).slice(0, 3).map((e) => `${e.field}: ${e.message}`)].filter(Boolean).join(" ");
      this.entries.unshift({ at: Date.now(), count: 1, code: error.code ?? "", detail: error.detail ?? error.message, remedy, request });
      this.entries.length = Math.min(this.entries.length, 100);
    }
    this.dispatchEvent(new Event("change"));
  }
}

export const refusals = new Refusals();

// What the strip asked for. It works without this log, so it asks whether somebody heard.
window.addEventListener("station-refused", (event) => {
  event.preventDefault();
  const { refusal, path } = event.detail;
  refusals.add({ ...refusal, remedy: forPerson(refusal.remedy ?? "") }, path ? { method: "POST", path } : {});
});

/** Return the remedies that are one click: a label and what the click does, or null. */
export function remedyOf(entry, state, actions) {
  const isMotion = ["stopped", "not_sent", "bench_refused"].includes(entry.code);
  if (isMotion && state.stop === "stopped") return { label: "Release stop", run: actions.release };
  if (isMotion && state.stop === "released") return { label: "Allow motion", run: actions.arm };
  if (entry.code === "control_held") return { label: "Take control …", run: actions.takeControl };
  const wanted = entry.request?.body?.start?.[0];
  if (entry.code === "resource_conflict" && wanted)
    return { label: `Stop the others and start ${wanted}`, run: () => actions.switchTo(wanted) };
  if (["arm_command_refused", "switch_refused"].includes(entry.code) && state.rescue?.action === "recover")
    return { label: state.rescue.label, run: actions.recover };
  const running = /controllers\/([\w.-]+)$/.exec(entry.request?.path ?? "");
  if (entry.code === "controller_state" && entry.request?.method === "DELETE" && running)
    return { label: `Stop ${running[1]}`, run: () => actions.stopController(running[1]) };
  if (["not_sent", "bench_refused"].includes(entry.code) && state.enabling?.name)
    return { label: "Enable sliders", run: actions.enable };
  return null;
}
