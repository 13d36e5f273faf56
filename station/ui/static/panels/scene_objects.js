// The objects of the scene: where they are, moved by arrows in the 3D view or by typing, added, duplicated, removed.
import { act, api, choice, field, h, html, live, number, Panel, press, refusals, repeat, send, store, typed } from "../lib/panel.js";

const LOOK_MS = 500;
/** The kinds that can be added, with their size at first and what it is [m]. */
const SIZES = { box: ["0.2, 0.2, 0.2", "edges"], sphere: ["0.1", "radius"], cylinder: ["0.05, 0.3", "radius, height"], capsule: ["0.05, 0.3", "radius, length"], half_space: ["", "none"] };
/** Where a new one is [m]: in the middle of the picture that all begin with, and beside an arm at rest. */
const PLACE = [0.4, -0.4, 0.3];
const pathOf = (name) => `/scene/${encodeURIComponent(name)}`;
const rounded = (list) => list.map((value) => number(value, 3)).join(", ");

customElements.define("st-scene-objects", class SceneObjects extends Panel {
  build() {
    this.chosen = ""; // the object at which the 3D view has arrows
    const words = (names) => names.map((name) => [name, name.replaceAll("_", " ")]);
    this.kind = choice("Kind of the new object", words(Object.keys(SIZES)), () => this.showSize());
    this.roleChoice = choice("Role of the new object", words(["keep_out", "fence"]));
    this.size = field("size", "", "m", "Size of the new object [m]");
    this.name = h("input", { class: "name", placeholder: "name", ariaLabel: "Name of the new object" });
    this.size.input.classList.add("wide");
    this.objects = [];
    this.showSize();
    this.every(LOOK_MS, () => this.look());
  }

  showSize() {
    const [size, words] = SIZES[this.kind.value];
    this.size.input.value = size;
    this.size.input.title = words;
    this.size.label.hidden = !size;
  }

  async look() {
    this.objects = (await api("GET", "/scene")).objects;
    if (this.chosen && !this.objects.some(({ name }) => name === this.chosen)) this.choose("");
    this.refresh();
  }

  view() {
    const rows = repeat(this.objects, ({ name }) => name, (thing) => this.row(thing));
    return html`<div class="scroll">${this.objects.length ? rows : html`<p class="hint">There is nothing around the robot.</p>`}</div>
      <div class="line"><b>New</b>${this.kind}${this.roleChoice}${this.size.label}${this.name}
        ${press("Add", "Add it 0.6 m from the world’s middle, at its front and right; arms keep clear of it at once.", () => this.add(), { needs: "change" })}</div>`;
  }

  row(thing) {
    const { name, type, size, position, mass, role, solid } = thing;
    const tool = (label, title, run, rule = {}) => press(label, title, run, { needs: "change", name: `${label} ${name}`, ...rule });
    // A field in which somebody types keeps what was typed.
    const typing = document.activeElement;
    const shown = live(typing?.dataset.object === name ? typing.value : rounded(position));
    const fixed = solid && "The simulated world is built once: it can be moved alone.";
    return html`<div class="line" role="group" aria-label=${name} title="${type} ${size.join(" × ")}"><b>${name}</b><small>${role === "object" ? (mass ? `${number(mass, 2)} kg` : "fixed") : role.replace("_", " ")}</small>
      <input class="value wide" data-object=${name} aria-label="Position of ${name} [m]" .value=${shown} ?disabled=${!store.can("change")} @keydown=${({ key, target }) => key === "Enter" && this.move(name, target)} /> m
      ${tool("Move", "Show arrows at it in the 3D view: drag them to move it.", () => this.choose(name === this.chosen ? "" : name), { pressed: name === this.chosen })}
      ${tool("Duplicate", fixed || "Add another one beside it.", () => this.duplicate(thing), { off: solid })}${tool("Remove", fixed || "Take it out of the scene.", () => this.change("DELETE", name), { off: solid })}</div>`;
  }

  /** Show arrows at an object in the 3D view of this session, or none. */
  choose(name) {
    this.chosen = name;
    send("PUT", "/ui/object", { name }).catch((error) => console.warn(error.message));
    this.refresh();
  }

  async change(method, name, body) {
    const answer = await act(method, pathOf(name), body);
    await this.look().catch(() => {}); // a lost station is in the strip
    return answer;
  }

  numbers(text) {
    const values = text.split(/[,;\s]+/).filter(Boolean).map(typed);
    if (!values.includes(null)) return values;
    refusals.add({ code: "not_a_number", detail: `“${text}” has to be numbers, separated by commas.`, remedy: "Type metres, such as 0.5, 0, 0.3." });
    return null;
  }

  async move(name, input) {
    const position = this.numbers(input.value);
    if (!position) return;
    input.blur();
    await this.change("PUT", name, { position });
  }

  /** Return a name that no object has yet. */
  free(name) {
    const taken = new Set(this.objects.map((one) => one.name));
    const stem = name.replace(/-\d+$/, "");
    let made = name;
    for (let i = 2; taken.has(made); i += 1) made = `${stem}-${i}`;
    return made;
  }

  async add() {
    const size = this.numbers(this.size.input.value);
    if (!size) return;
    const name = this.free(this.name.value.trim() || this.kind.value);
    if (!(await this.change("PUT", name, { type: this.kind.value, size, role: this.roleChoice.value, position: PLACE }))) return;
    this.name.value = "";
    this.choose(name);
  }

  async duplicate({ name, type, size, position: [x, y, z], orientation, role, margin, links, colour, file }) {
    const made = this.free(name);
    const beside = [x, y + (size[type === "box" || type === "table" ? 1 : 0] ?? 0.1) + 0.05, z];
    if (await this.change("PUT", made, { type, size, position: beside, orientation, role, margin, links, colour, file })) this.choose(made);
  }
});
