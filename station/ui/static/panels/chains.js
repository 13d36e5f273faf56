// Chains: who commands whose references, drawn from the first controller to the last.
import { h } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { api } from "../lib/station.js";
import { store } from "../lib/store.js";

class Chains extends Panel {
  /** Ask anew when a controller came, went, started or stopped. */
  refresh() {
    const states = store.docks.controllers.map((c) => `${c.name} ${c.state}`).join();
    if (states === this.states) return;
    this.states = states;
    this.look();
  }

  async look() {
    const told = await api("GET", "/controllers/chains").catch(() => null); // a lost station is in the strip
    if (!told) return (this.states = ""); // asked again
    const all = new Map(told.controllers.map((c) => [c.name, c]));
    const commanded = new Set(told.controllers.flatMap((c) => c.following));
    const heads = told.controllers.filter((c) => c.following.length && !commanded.has(c.name));
    this.replaceChildren(...heads.map((head) => h("p", { class: "hint" }, levelsOf(head, all).map(drawn).join(" → "))));
    return undefined;
  }
}

/** Return the controllers of a chain, level by level: those that a level commands are the next. */
function levelsOf(head, all) {
  const levels = [[head]];
  for (let last = levels[0]; last.length; last = levels.at(-1)) {
    const names = new Set(last.flatMap((c) => c.following));
    levels.push([...names].map((name) => all.get(name)).filter(Boolean));
  }
  return levels.slice(0, -1);
}

const drawn = (level) => level.map((c) => `${c.state === "running" ? "●" : "○"} ${c.name}${c.is_in_chained_mode ? " (chained)" : ""}`).join(", ");

customElements.define("st-chains", Chains);
