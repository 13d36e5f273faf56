// Tuning: gains of one controller, changed together; undo; sets; a bench for one joint.
import "./bench.js";
import "./tune_search.js";
import { act, api, button, choice, decide, h, html, line, live, nameField, nothing, number, offer, Panel, peek, press, rangeOf, Refusal, refusals, render, shortNames, show, store, typed } from "../lib/panel.js";

/** The names that the station can keep as files. */
const NAME = /^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}$/;

/** Sets of gains, kept by the station: save, compare with the gains in force, apply. */
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
    const answer = await peek("/gain-sets");
    if (!answer) return;
    this.undoable = answer.undoable_changes;
    offer(this.sets, answer.gain_sets);
    if (answer.gain_sets.includes(chosen)) this.sets.value = chosen;
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

customElements.define("st-tuning", class Tuning extends Panel {
  build() {
    this.typed = new Map(); // what somebody has typed and not applied, by the gain
    this.choice = choice("Controller to tune", [], () => this.read(), { title: "Controller whose gains are shown." });
    this.joint = choice("Joint to tune", [], () => this.drawGains(), { title: "Joint of tests and of the search." });
    const undo = button("Undo", "Take the last change of gains back.", () => act("POST", "/gain-sets/undo").then(() => this.reread()), { needs: "change", off: () => !this.sets.undoable });
    const apply = button("Apply", "All changed values take effect in the same cycle.", () => this.patch(), { class: "s primary", needs: "change", off: () => !this.isTyped });
    this.fields = h("div", { class: "gains" });
    this.state = h("p", { class: "hint state" }, "");
    this.sets = h("st-gain-sets");
    this.bench = h("st-bench", { class: "bench" });
    this.bench.tuning = this;
    this.search = h("st-tune-search");
    this.search.tuning = this;
    this.append(line(this.choice, this.joint, apply, undo), this.fields, this.state, this.sets, this.bench, this.search);
    // Gains are changed by scripts and other pages, too, and are others after a restart.
    store.addEventListener("gains", () => {
      if (!this.isShown) return (this.names = null); // read when the dock is opened
      this.read();
      this.sets.list();
    });
  }

  /** Whether a value was typed that is not applied yet. */
  get isTyped() {
    return [...this.typed].some(([key, text]) => typed(text) !== this.gains.values[key]);
  }

  /** The controller and joint that are tuned. */
  get chosen() {
    return { controller: this.choice.value, joint: this.joint.value };
  }

  /** p, i and d of the joint that is tuned, as far as its controller has them. */
  gainsOfJoint() {
    const values = this.gains?.values ?? {};
    const start = `${this.joint.value}/p` in values ? `${this.joint.value}/` : "";
    return Object.fromEntries(["p", "i", "d"].filter((key) => start + key in values).map((key) => [key, values[start + key]]));
  }

  /** Read the gains anew; what was typed and not applied is given up. */
  reread() {
    this.drawnFor = null;
    this.sets.list();
    return this.read();
  }

  refresh() {
    const names = store.docks.controllers.filter((c) => c.resources.length && c.state !== "loading").map((c) => c.name);
    if (this.isOld && store.docks.link === "live") this.read();
    if (names.join() === this.names) return this.follow();
    this.names = names.join();
    offer(this.choice, names, "none loaded");
    this.follow();
    this.read();
    this.sets.list();
  }

  /** Show the controller that has just been started, unless that would lose what was typed. */
  follow() {
    const running = store.docks.operated.names[0];
    if (!running || running === this.followed || this.isTyped) return;
    this.followed = running;
    if (this.choice.value === running) return;
    this.choice.value = running;
    this.read();
  }

  async read() {
    const name = this.choice.value;
    if (!name) return;
    const gains = await api("GET", `/controllers/${name}/gains`).catch(({ status }) => (status >= 400 && status < 500 ? { values: {}, schema: {}, etag: "" } : null));
    // A station that is lost keeps what is shown and typed, and is asked again when it is back.
    this.isOld = gains === null;
    if (this.isOld) return;
    // Another controller was chosen meanwhile: its answer comes, or was here before this one.
    if (name !== this.choice.value) return;
    this.gains = gains;
    const joints = [...new Set(Object.keys(this.gains.values).map((key) => key.split("/")).filter((parts) => parts.length > 1).map((parts) => parts[0]))];
    this.joints = shortNames(joints);
    offer(this.joint, [...this.joints], "no joint");
    this.joint.hidden = joints.length === 0;
    this.drawGains();
  }

  drawGains() {
    const keys = Object.keys(this.gains.values);
    const drawnFor = `${this.choice.value} ${keys.join()}`;
    if (drawnFor !== this.drawnFor) {
      this.drawnFor = drawnFor;
      this.typed.clear();
      show(this.state, keys.length ? "Change values, then Apply: they take effect together, and Undo takes them back." : "This controller has no gains that can be changed while it runs.");
    }
    const single = keys.filter((key) => !key.includes("/"));
    const field = (key) => html`<label title=${this.titleOf(key)}><span>${key}</span>${this.input(key)}<small>${this.gains.schema[key].unit}</small></label>`;
    render(html`<div class="fields">${single.map(field)}</div>${keys.length > single.length ? this.gainTable(keys) : nothing}`, this.fields);
    this.search.hidden = !keys.length && !this.search.name;
    this.bench.choose();
    this.bench.refresh();
    this.bench.drawProposals();
    decide();
  }

  /** Gains as a table: a row for each joint, a column for each gain; tests and the search move the chosen joint. */
  gainTable(keys) {
    const gains = [...new Set(keys.filter((key) => key.includes("/")).map((key) => key.slice(key.indexOf("/") + 1)))];
    const first = (gain) => keys.find((key) => key.endsWith(`/${gain}`));
    const head = (gain) => html`<th title=${this.titleOf(first(gain))}>${gain}<small>${this.gains.schema[first(gain)].unit}</small></th>`;
    const cell = (key) => html`<td>${key in this.gains.values ? this.input(key) : "–"}</td>`;
    const row = ([joint, label]) => html`<tr class=${joint === this.joint.value ? "chosen" : ""}><th scope="row">${label}</th>${gains.map((gain) => cell(`${joint}/${gain}`))}</tr>`;
    return html`<div class="scroll"><table><thead><tr><th>joint</th>${gains.map(head)}</tr></thead><tbody>${[...this.joints].map(row)}</tbody></table></div>`;
  }

  titleOf(key) {
    const schema = this.gains.schema[key];
    return [`${schema.description} [${schema.unit || "no unit"}]`, rangeOf(schema)].filter(Boolean).join(", ");
  }

  input(key) {
    const parts = key.split("/");
    const label = `${parts.at(-1)} of ${parts.length > 1 ? parts[0] : this.choice.value}`;
    const value = String(this.gains.values[key]);
    const shown = this.typed.get(key) ?? value;
    const type = ({ target }) => (target.value === value ? this.typed.delete(key) : this.typed.set(key, target.value));
    const enter = (event) => event.key === "Enter" && this.patch();
    const options = choicesOf(this.gains.schema[key])?.map(([each, text]) => html`<option value=${each} .selected=${live(each === shown)}>${text}</option>`);
    if (options) return html`<select aria-label=${label} title=${this.titleOf(key)} @input=${type} @keydown=${enter}>${options}</select>`;
    return html`<input class="value" inputmode="decimal" autocomplete="off" aria-label=${label} title=${this.titleOf(key)} .value=${live(shown)} @input=${type} @keydown=${enter} />`;
  }

  async patch() {
    const values = {};
    for (const [key, text] of this.typed) {
      const value = typed(text);
      if (value === null) return refusals.add({ code: "not_a_number", detail: `${key}: “${text}” is not a number.` });
      if (value !== this.gains.values[key]) values[key] = value;
    }
    if (!Object.keys(values).length) return show(this.state, "Nothing was changed.");
    const path = `/controllers/${this.choice.value}/gains`;
    try {
      const done = await api("PATCH", path, { values }, { "If-Match": this.gains.etag });
      const what = Object.entries(values).map(([key, value]) => `${key} ${done.previous[key]} → ${value}`);
      for (const key of Object.keys(values)) this.typed.delete(key); // shows what the station has
      await this.read();
      show(this.state, `Applied in cycle ${done.cycle}: ${what.join(", ")}.`);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refusals.add(error, { method: "PATCH", path, body: { values } });
      await this.read();
      if (error.status === 412) show(this.state, "Somebody has changed these gains meanwhile. They were read anew, and what you typed is still here: look, then Apply again.");
    }
  }
});

/** Return the choices of a gain that is an enumeration: its description numbers them. */
function choicesOf(schema) {
  const listed = /:\s*(\d+ [^,]+(?:, \d+ [^,]+)+)$/.exec(schema.description ?? "");
  if (!listed || schema.unit) return null;
  return listed[1].split(", ").map((part) => [part.split(" ")[0], part.replace(/^\d+ (of )?/, "")]);
}
