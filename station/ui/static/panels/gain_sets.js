// Sets of gains, kept by the station: save, compare with the gains in force, apply.
import { button as plainButton, h, line, offer, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { refusals } from "../lib/refusals.js";
import { act, api } from "../lib/station.js";
import { store } from "../lib/store.js";
import { number } from "../lib/text.js";

/** The names that the station can keep as files. */
const NAME = /^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$/;

class GainSets extends Panel {
  build() {
    this.sets = h("select", { title: "Saved sets of gains, kept by the station.", ariaLabel: "Set of gains", onchange: () => this.showDiff() });
    this.setName = h("input", { class: "name", placeholder: "name", ariaLabel: "Name of the set", oninput: () => this.refresh() });
    this.setName.addEventListener("keydown", (event) => event.key === "Enter" && this.save());
    this.diff = h("p", { class: "hint" });
    const button = (label, title, run) => plainButton(label, title, run, { disabled: true });
    this.applyButton = button("Apply set", "Put the set into force, all controllers in one cycle", () => this.apply());
    this.deleteButton = button("Delete", "Delete the set", () => this.remove());
    this.saveButton = button("Save", "Save the gains of all controllers now", () => this.save());
    this.append(h("details", {}, h("summary", {}, "Sets of gains"), line(this.sets, this.applyButton, this.deleteButton, this.setName, this.saveButton), this.diff));
  }

  get path() {
    return `/gain-sets/${encodeURIComponent(this.sets.value)}`;
  }

  /** Disable what cannot do anything: there is no set, or no name for one. */
  refresh() {
    this.applyButton.disabled = this.deleteButton.disabled = !this.sets.value || !store.isOperator;
    this.saveButton.disabled = !this.setName.value.trim() || !store.isOperator;
  }

  async apply() {
    await act("POST", `${this.path}/apply`, {});
    this.showDiff();
  }

  async remove() {
    await act("DELETE", this.path);
    this.list();
  }

  async save() {
    const name = this.setName.value.trim();
    if (!name) return this.setName.focus();
    if (!NAME.test(name)) return refusals.add({ code: "invalid_name", detail: `“${name}” cannot be the name of a set.`, remedy: "Use letters, digits, “_”, “.” and “-”, at most 100; no spaces, and no “.” or “-” at the start." });
    if (!(await act("PUT", `/gain-sets/${encodeURIComponent(name)}`, {}))) return undefined;
    this.setName.value = "";
    return this.list(name);
  }

  /** Ask which sets there are; `chosen` is shown, if it is one of them. */
  async list(chosen = this.sets.value) {
    const told = await api("GET", "/gain-sets").catch(() => null); // a lost station is in the strip
    if (!told) return;
    const names = told.gain_sets;
    offer(this.sets, names);
    if (names.includes(chosen)) this.sets.value = chosen;
    this.refresh();
    await this.showDiff();
  }

  async showDiff() {
    if (!this.sets.value) return show(this.diff, "Save the present gains under a name to come back to them.");
    const set = await api("GET", this.path).catch(() => null);
    if (!set) return show(this.diff, "This set cannot be read; somebody may have deleted it.");
    const lines = set.differences.map((d) => `${d.controller} ${d.name}: set ${number(d.saved, 4)}, now ${number(d.present, 4)}`);
    return show(this.diff, lines.length ? `Differs from the present gains: ${lines.join("; ")}.` : "The set is in force: no gain differs.");
  }
}

customElements.define("st-gain-sets", GainSets);
