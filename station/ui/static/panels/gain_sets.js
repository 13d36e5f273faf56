// Sets of gains, kept by the station: save, compare with the gains in force, apply.
import { act, choice, html, nameField, number, offer, Panel, peek, press, refusals } from "../lib/panel.js";

/** The names that the station can keep as files. */
const NAME = /^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$/;

customElements.define("st-gain-sets", class GainSets extends Panel {
  build() {
    this.sets = choice("Set of gains", [], () => this.showDiff(), { title: "Saved sets of gains, kept by the station." });
    this.setName = nameField("Name of the set", "name", () => this.save());
    this.differs = "";
    this.refresh();
  }

  get path() {
    return `/gain-sets/${encodeURIComponent(this.sets.value)}`;
  }

  view() {
    const ofSet = { needs: "change", off: () => !this.sets.value };
    return html`<details><summary>Sets of gains</summary><div class="line">${this.sets}
        ${press("Apply set", "Put the set into force, all controllers in one cycle", () => act("POST", `${this.path}/apply`, {}).then(() => this.showDiff()), ofSet)}
        ${press("Delete", "Delete the set", () => act("DELETE", this.path).then(() => this.list()), ofSet)}${this.setName}
        ${press("Save", "Save the gains of all controllers now", () => this.save(), { needs: "change", off: () => !this.setName.value.trim() })}</div>
      <p class="hint">${this.differs}</p></details>`;
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
    const told = await peek("/gain-sets");
    if (!told) return;
    this.undoable = told.undoable_changes;
    offer(this.sets, told.gain_sets);
    if (told.gain_sets.includes(chosen)) this.sets.value = chosen;
    await this.showDiff();
  }

  async showDiff() {
    const set = this.sets.value && (await peek(this.path));
    const lines = set?.differences?.map((d) => `${d.controller} ${d.name}: set ${number(d.saved, 4)}, now ${number(d.present, 4)}`);
    if (!this.sets.value) this.differs = "Save the present gains under a name to come back to them.";
    else if (!set) this.differs = "This set cannot be read; somebody may have deleted it.";
    else this.differs = lines.length ? `Differs from the present gains: ${lines.join("; ")}.` : "The set is in force: no gain differs.";
    this.refresh();
  }
});
