// Loading a controller: its type, and its parameters, which the type declares with unit and
// default, in fields or as YAML.
import { act, api, breakable, button, choice, h, html, line, Panel, rangeOf, Refusal, refusals, render, said, send, shortNames, show, store, switchTo, typed } from "../lib/panel.js";

customElements.define("st-load-form", class LoadForm extends Panel {
  toggle() {
    this.hidden = !this.hidden;
    if (!this.hidden) this.offerTypes();
  }

  /** Show the types that suit this robot and have the words of the search in their names. */
  offerTypes(words = "") {
    const search = h("input", { type: "search", value: words, placeholder: "search a type, e.g. group position", ariaLabel: "Search controller types", oninput: () => fill() });
    const list = h("div", { class: "types", role: "listbox", ariaLabel: "Controller types" });
    const type = (name) => html`<button class="type" type="button" role="option" @click=${() => this.chooseType(name)}>${name}</button>`;
    const fill = () => {
      const words = search.value.toLowerCase().split(/\s+/);
      // Some types are for Franka arms.
      const suitsRobot = (name) => store.docks.arms.length > 0 || !name.startsWith("franka_");
      const fits = store.docks.types.filter((name) => suitsRobot(name) && words.every((word) => name.toLowerCase().includes(word)));
      render(fits.length ? fits.map(type) : html`<p class="hint">No type has “${search.value.trim()}” in its name. Try fewer words, e.g. position.</p>`, list);
    };
    this.replaceChildren(h("p", { class: "hint" }, "Which type? The parameters of the next step are filled in for this robot."), search, list);
    this.search = search;
    fill();
    search.focus();
  }

  /** Show the parameters of a type, filled in for this robot, or for one of its arms. */
  async chooseType(type, arm = "") {
    const example = await send("GET", `/workspace/example?${new URLSearchParams({ type, arm })}`);
    const { controller_types: types } = await api("GET", "/controller-types");
    const known = types.find((each) => each.type === type);
    this.declared = known?.parameters ?? [];
    this.fields = h("div", { class: "fields" });
    this.text = h("textarea", { rows: 8, value: example.yaml, spellcheck: false, ariaLabel: "Parameters in YAML" });
    this.other = button("", undefined, () => this.changeView());
    this.fill(example.params);
    this.other.hidden = !this.inputs.length;
    this.showView(!this.inputs.length);
    const name = h("input", { value: example.name, ariaLabel: "Name of the controller" });
    const load = (label, look, needs) => button(label, undefined, () => this.load(name.value.trim(), type, needs === "motion"), { class: look, needs, off: () => !name.value.trim() });
    const buttons = line(load("Load", "s", "change"), load("Load and start", "s primary", "motion"), this.other, button("Back", undefined, () => this.offerTypes(this.search.value)));
    const arms = store.docks.arms.map((one) => one.arm_id);
    const ofArm = choice("Arm of the controller", arms, () => this.chooseType(type, ofArm.value));
    ofArm.value = arm || arms[0];
    const chooser = h("label", { hidden: arms.length < 2 || !type.startsWith("franka_") }, "arm", ofArm);
    this.replaceChildren(h("p", {}, h("b", {}, type), " ", known?.description ?? ""), chooser, h("label", {}, "name", name), this.fields, this.text, buttons);
  }

  /** Make the fields for some parameters, and for those that are declared besides. */
  fill(params) {
    this.inputs = fieldsOf(params, this.declared, shortNames(store.docks.joints));
    render(this.inputs.map((field) => field.row), this.fields);
  }

  showView(isText) {
    this.text.hidden = !isText;
    this.fields.hidden = isText;
    show(this.other, isText ? "Edit as fields" : "Edit as YAML");
  }

  /** Show the other view of the same values; what cannot be read is said, and the view stays. */
  async changeView() {
    const params = await this.read();
    if (params === undefined) return;
    if (this.text.hidden) {
      this.text.value = (await send("POST", "/workspace/yaml", { params })).yaml;
      return this.showView(true);
    }
    const fields = fieldsOf(params, this.declared, new Map());
    if (!isSame(params, fields)) return refusals.add({ code: "not_in_fields", detail: "The fields cannot hold all of these parameters, e.g. lists of mappings or empty values.", remedy: "Load them from here." });
    this.fill(params);
    return this.showView(false);
  }

  /** Return the parameters of the view that is shown; undefined, and said, if it cannot be read. */
  async read() {
    const read = async () => (this.text.hidden ? valuesOf(this.inputs) : (await send("POST", "/workspace/parameters", this.text.value)).params);
    return said(read());
  }

  async load(name, type, andStart) {
    const params = await this.read();
    if (params === undefined) return;
    const loaded = await act("POST", "/controllers", { name, type, params });
    if (!loaded) return;
    await store.refresh();
    this.hidden = true;
    if (andStart) await switchTo(loaded.name);
  }
});

/** Return whether fields hold just these parameters. */
function isSame(params, fields) {
  try {
    return JSON.stringify(valuesOf(fields)) === JSON.stringify(params);
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    return false;
  }
}

/** Return whether a declared name such as `<joint>/pid/p` stands for a path. */
function standsFor(name, path) {
  const parts = name.split("/");
  return parts.length === path.length && parts.every((part, i) => part === "<joint>" || part === path[i]);
}

function kindOf(declared, value) {
  if (declared) return declared.type;
  if (Array.isArray(value)) return value.every((each) => typeof each === "number") ? "numbers" : "strings";
  return typeof value;
}

function field(path, value, declared, names) {
  const kind = kindOf(declared, value);
  const text = Array.isArray(value) ? value.join(", ") : String(value ?? "");
  const byDefault = declared?.default == null ? (declared?.default_text ?? "") : [declared.default].flat().join(", ") || "none";
  const choices = kind === "boolean" ? ["true", "false"] : (declared?.choices ?? []);
  const label = path.join(" / ");
  const hint = byDefault && `default: ${byDefault}`;
  const isChoice = choices.length && !kind.endsWith("s");
  const input = isChoice ? choice(label, [["", hint || "–"], ...choices]) : h("input", { placeholder: hint, ariaLabel: label });
  input.value = text;
  const shown = path.map((part) => names.get(part) ?? part).join("/");
  const facts = declared ? [shown === label ? "" : label, declared.description, rangeOf(declared), choices.join(", ")].filter(Boolean).join("; ") : "";
  const unit = [declared?.unit, declared?.required ? "required" : ""].filter(Boolean).join(", ");
  return { path, input, kind, row: html`<label title=${facts}><span>${breakable(shown, "_")}</span>${input}<small>${unit}</small></label>` };
}

function leaves(params, path = []) {
  return Object.entries(params).flatMap(([key, value]) =>
    value !== null && typeof value === "object" && !Array.isArray(value) ? leaves(value, [...path, key]) : [[[...path, key], value]],
  );
}

/**
 * Return fields for the parameters of an example and for every other one that is declared.
 * Parameters of each joint are offered where the example has them, and in YAML. `names` are
 * the short names of joints.
 */
function fieldsOf(params, declared, names) {
  const found = leaves(params);
  const fields = found.map(([path, value]) => field(path, value, declared.find((each) => standsFor(each.name, path)), names));
  const others = declared.filter((each) => each.type !== "mappings" && !each.name.includes("<") && !found.some(([path]) => standsFor(each.name, path)));
  return [...fields, ...others.map((each) => field(each.name.split("/"), undefined, each, names))];
}

function valueOf({ path, input, kind }) {
  const text = input.value.trim();
  const numeric = (part) => {
    const value = typed(part);
    if (value === null) throw new Refusal(0, { code: "not_a_number", detail: `${path.join(" / ")}: “${part}” is not a number.` });
    return value;
  };
  const parts = text.split(",").map((part) => part.trim()).filter(Boolean);
  if (kind === "number") return numeric(text);
  if (kind === "boolean") return text === "true";
  if (kind === "numbers") return parts.map(numeric);
  if (kind === "strings") return parts;
  if (kind === "number_or_numbers") return parts.length > 1 ? parts.map(numeric) : numeric(text);
  return text;
}

/** Return the parameters; an empty field is left out, so that its default holds. */
function valuesOf(fields) {
  const params = {};
  for (const each of fields) {
    if (each.input.value.trim() === "") continue;
    let place = params;
    for (const key of each.path.slice(0, -1)) place = place[key] ??= {};
    place[each.path.at(-1)] = valueOf(each);
  }
  return params;
}
