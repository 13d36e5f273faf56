// Loading a controller: its type, and its parameters in fields or as YAML.
import { button as plainButton, h, line, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { fieldsOf, valuesOf } from "../lib/parameter_fields.js";
import { refusals } from "../lib/refusals.js";
import { act, api, Refusal, send } from "../lib/station.js";
import { store, switchTo } from "../lib/store.js";
import { shortNames } from "../lib/text.js";

class LoadForm extends Panel {
  toggle() {
    this.hidden = !this.hidden;
    if (this.hidden) return;
    const search = h("input", { type: "search", placeholder: "search a type, e.g. group position", ariaLabel: "Search controller types" });
    const list = h("div", { class: "types", role: "listbox", ariaLabel: "Controller types" });
    const fill = () => {
      const words = search.value.toLowerCase().split(/\s+/);
      const fits = store.docks.types.filter((type) => suitsRobot(type) && words.every((word) => type.toLowerCase().includes(word)));
      list.replaceChildren(...fits.map((type) => plainButton(type, undefined, () => this.chooseType(type), { class: "type", role: "option" })));
      if (!fits.length) list.append(h("p", { class: "hint" }, `No type has “${search.value.trim()}” in its name. Try fewer words, e.g. position.`));
    };
    search.addEventListener("input", fill);
    this.chosen = h("div", {});
    this.typeList = h("div", {}, h("p", { class: "hint" }, "Which type? The parameters of the next step are filled in for this robot."), search, list);
    this.replaceChildren(this.typeList, this.chosen);
    fill();
    search.focus();
  }

  /** Show the parameters of a type, filled in for this robot, or for one of its arms. */
  async chooseType(type, arm = "") {
    const query = new URLSearchParams({ type, arm });
    const example = await send("GET", `/workspace/example?${query}`);
    const { controller_types: types } = await api("GET", "/controller-types");
    const known = types.find((each) => each.type === type);
    this.declared = known?.parameters ?? [];
    this.typeList.hidden = true;
    this.view = h("div", { class: "fields" });
    this.text = h("textarea", { rows: 8, value: example.yaml, spellcheck: false, ariaLabel: "Parameters in YAML" });
    this.other = plainButton("", undefined, () => this.changeView());
    this.fill(example.params);
    this.other.hidden = !this.inputs.length;
    this.showView(!this.inputs.length);
    const name = h("input", { value: example.name, ariaLabel: "Name of the controller" });
    const button = (label, andStart) => plainButton(label, undefined, () => this.load(name.value.trim(), type, andStart), { class: andStart ? "s primary" : "s", disabled: !store.isOperator });
    const back = plainButton("Back", undefined, () => {
      this.typeList.hidden = false;
      this.chosen.replaceChildren();
    });
    const parts = [h("p", {}, h("b", {}, type), " ", known?.description ?? ""), this.armChoice(type, arm), h("label", {}, "name", name), this.view, this.text, line(button("Load", false), button("Load and start", true), this.other, back)];
    this.chosen.replaceChildren(...parts.filter(Boolean));
  }

  /** Return a choice of the arm for a type that is of one; null where there is nothing to choose. */
  armChoice(type, arm) {
    const arms = store.docks.arms.map((one) => one.arm_id);
    if (arms.length < 2 || !type.startsWith("franka_")) return null;
    const choice = h("select", {}, ...arms.map((name) => h("option", {}, name)));
    choice.value = arm || arms[0];
    choice.setAttribute("aria-label", "Arm of the controller");
    choice.addEventListener("change", () => this.chooseType(type, choice.value));
    return h("label", {}, "arm", choice);
  }

  /** Make the fields for some parameters, and for those that are declared besides. */
  fill(params) {
    this.inputs = fieldsOf(params, this.declared, shortNames(store.docks.joints));
    this.view.replaceChildren(...this.inputs.map((field) => field.row));
  }

  showView(isText) {
    this.text.hidden = !isText;
    this.view.hidden = isText;
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
    try {
      if (this.text.hidden) return valuesOf(this.inputs);
      return (await send("POST", "/workspace/parameters", this.text.value)).params;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refusals.add(error, {});
      return undefined;
    }
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
}

/** Return whether fields hold just these parameters. */
function isSame(params, fields) {
  try {
    return JSON.stringify(valuesOf(fields)) === JSON.stringify(params);
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    return false;
  }
}

/** Return whether a robot like this one can have a controller of a type: some are for Franka arms. */
function suitsRobot(type) {
  return store.docks.arms.length > 0 || !type.startsWith("franka_");
}

customElements.define("st-load-form", LoadForm);
