// Controllers: a row for each, what a switch would do before the click, and loading.
import { h, number, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { fieldsOf, valuesOf } from "../lib/parameter_fields.js";
import { act, api, send } from "../lib/station.js";
import { refusals } from "../lib/refusals.js";
import { restartController, stopController, store, switchTo } from "../lib/store.js";

const SYMBOLS = { running: "●", initialized: "○", stopped: "○", loading: "…", aborted: "✖", waiting: "…" };

const SIGNS = { Restart: "↻", Unload: "✕" };

class Controllers extends Panel {
  build() {
    const load = h("button", { class: "s", type: "button" }, "Load …");
    load.addEventListener("click", () => this.openForm());
    this.tools.append(load);
    const heads = ["controller", "state", "claims", "update", ""].map((text) => h("th", {}, text));
    heads[3].title = "Median time that an update takes in the control cycle; 99 of 100 in the tooltip of each cell";
    this.body = h("tbody", {});
    this.preview = h("p", { class: "hint preview", role: "status" }, "Point at Start to see what a switch stops and how far the joints would step.");
    this.form = h("div", { class: "form", hidden: true });
    this.append(
      this.preview,
      this.form,
      h("div", { class: "scroll" }, h("table", { class: "controllers" }, h("thead", {}, h("tr", {}, ...heads)), this.body)),
    );
  }

  refresh() {
    const key = JSON.stringify(store.docks.controllers.map((c) => ({ ...c, update_p50: 0, update_p99: 0, update_count: 0 }))) + store.isOperator;
    if (key !== this.shown) {
      this.shown = key;
      const focused = document.activeElement?.dataset?.key;
      this.cells = new Map();
      const rank = (c) => (c.state === "running" ? 0 : c.resources.length ? 1 : 2);
      const rows = [...store.docks.controllers].sort((a, b) => rank(a) - rank(b));
      this.body.replaceChildren(...rows.map((c) => this.row(c)));
      if (focused) this.body.querySelector(`[data-key="${CSS.escape(focused)}"]`)?.focus();
    }
    for (const c of store.docks.controllers) {
      const cell = this.cells.get(c.name);
      show(cell, c.update_count ? `${number(c.update_p50 * 1e6, 0)} µs` : "–");
      cell.title = c.update_count ? `p99 ${number(c.update_p99 * 1e6, 0)} µs, ${c.update_count} updates` : "It has not run yet";
    }
  }

  row(c) {
    const button = (label, title, run, look) => {
      const made = h("button", { class: label === "Start" ? "s primary" : "s", type: "button", title, disabled: !store.isOperator }, SIGNS[label] ?? label);
      made.setAttribute("aria-label", `${label} ${c.name}`);
      made.dataset.key = `${label} ${c.name}`;
      made.addEventListener("click", run);
      if (look) for (const name of ["pointerenter", "focus"]) made.addEventListener(name, look);
      return made;
    };
    const update = h("td", { class: "update" });
    this.cells.set(c.name, update);
    const actions =
      c.state === "running"
        ? [
            button("Stop", `Stop ${c.name}; its joints hold`, () => stopController(c.name)),
            button("Restart", `Stop ${c.name} and start it again`, () => restartController(c.name), () => show(this.preview, `Restart ${c.name}: its joints hold, and it starts anew from where they are.`)),
          ]
        : [
            button("Start", c.reason || `Start ${c.name}`, () => switchTo(c.name), () => this.look(c)),
            button("Unload", `Unload ${c.name}`, () => this.unload(c)),
          ];
    const fault = c.fault ? h("div", { class: "fault" }, `✖ ${c.fault}`) : null;
    return h(
      "tr",
      { class: c.state },
      h("th", { scope: "row", title: `${c.name}\n${c.type}` }, ...breakable(c.name, "_"), h("small", {}, ...breakable(c.type, "/")), fault),
      h("td", { class: "state", title: c.state }, `${SYMBOLS[c.state] ?? "○"} ${c.state === "initialized" ? "ready" : c.state}`),
      h("td", { class: "claims", title: c.claims }, ...c.claims_short.map((claim) => h("div", {}, claim.replace("-", "\u2011")))),
      update,
      h("td", { class: "actions" }, ...actions),
    );
  }

  async unload(c) {
    await act("DELETE", `/controllers/${c.name}`);
    await store.refresh();
  }

  /** Ask the station what a switch would do; nothing is done. */
  async look(c) {
    const stop = store.controller(c.name)?.replaces ?? [];
    try {
      const plan = await api("POST", "/controllers/switch", { start: [c.name], stop, dry_run: true });
      const steps = Object.entries(plan.jump).filter(([, size]) => size != null);
      const [joint, size] = steps.reduce((most, one) => (Math.abs(one[1]) > Math.abs(most[1]) ? one : most), ["", 0]);
      const stops = plan.stopped.length ? `stops ${plan.stopped.join(", ")}; ` : "stops nothing; ";
      const jump = steps.length ? `largest step ${Math.abs(size).toFixed(4)} rad${joint ? ` (${joint})` : ""}` : "the step is known when it runs";
      show(this.preview, `Start ${c.name}: ${stops}${jump}.`);
      this.preview.title = steps.map(([name, step]) => `${name}: ${step}`).join("\n");
    } catch (error) {
      show(this.preview, `Start ${c.name} would be refused: ${error.detail ?? error.message} ${error.remedy ?? ""}`);
    }
  }

  openForm() {
    this.form.hidden = !this.form.hidden;
    if (this.form.hidden) return;
    const search = h("input", { type: "search", placeholder: "search a type, e.g. group position" });
    search.setAttribute("aria-label", "Search controller types");
    const list = h("div", { class: "types", role: "listbox" });
    list.setAttribute("aria-label", "Controller types");
    const fill = () => {
      const words = search.value.toLowerCase().split(/\s+/);
      const fits = store.docks.types.filter((type) => suitsRobot(type) && words.every((word) => type.toLowerCase().includes(word)));
      list.replaceChildren(
        ...fits.map((type) => {
          const choice = h("button", { class: "type", type: "button", role: "option" }, type);
          choice.addEventListener("click", () => this.chooseType(type));
          return choice;
        }),
      );
      if (!fits.length) list.append(h("p", { class: "hint" }, `No type has “${search.value.trim()}” in its name. Try fewer words, e.g. position.`));
    };
    search.addEventListener("input", fill);
    this.fields = h("div", {});
    this.typeList = h("div", {}, h("p", { class: "hint" }, "Which type? The parameters of the next step are filled in for this robot."), search, list);
    this.form.replaceChildren(this.typeList, this.fields);
    fill();
    search.focus();
  }

  async chooseType(type) {
    const example = await send("GET", `/workspace/example?type=${encodeURIComponent(type)}`);
    const { controller_types: types } = await api("GET", "/controller-types");
    const known = types.find((each) => each.type === type);
    this.typeList.hidden = true;
    const name = h("input", { value: example.name });
    name.setAttribute("aria-label", "Name of the controller");
    const view = h("div", { class: "fields" });
    const text = h("textarea", { rows: 8, value: example.yaml, hidden: true, spellcheck: false });
    text.setAttribute("aria-label", "Parameters in YAML");
    const inputs = fieldsOf(example.params, known?.parameters ?? []);
    view.append(...inputs.map((field) => field.row));
    if (!inputs.length) {
      text.hidden = false;
      view.hidden = true;
    }
    const other = h("button", { class: "s", type: "button" }, text.hidden ? "Edit as YAML" : "Edit as fields");
    other.hidden = !inputs.length;
    other.addEventListener("click", () => {
      text.hidden = !text.hidden;
      view.hidden = !text.hidden;
      show(other, text.hidden ? "Edit as YAML" : "Edit as fields");
    });
    const load = async (andStart) => {
      const params = text.hidden ? readFields(inputs) : await readYaml(text.value);
      if (params === undefined) return;
      const loaded = await act("POST", "/controllers", { name: name.value.trim(), type, params });
      if (!loaded) return;
      await store.refresh();
      this.form.hidden = true;
      if (andStart) await switchTo(loaded.name);
    };
    const button = (label, andStart) =>
      h("button", { class: andStart ? "s primary" : "s", type: "button", onclick: () => load(andStart), disabled: !store.isOperator }, label);
    const back = h("button", { class: "s", type: "button" }, "Back");
    back.addEventListener("click", () => {
      this.typeList.hidden = false;
      this.fields.replaceChildren();
    });
    this.fields.replaceChildren(
      h("p", {}, h("b", {}, type), " ", known?.description ?? ""),
      h("label", {}, "name", name),
      view,
      text,
      h("div", { class: "line" }, button("Load", false), button("Load and start", true), other, back),
    );
  }
}

/** Return whether a robot like this one can have a controller of a type: some are for Franka arms. */
function suitsRobot(type) {
  return store.docks.arms.length > 0 || !type.startsWith("franka_");
}

/** Return a long name that may be broken after a sign and nowhere else. */
function breakable(text, sign) {
  return text.split(sign).flatMap((part, i, all) => (i < all.length - 1 ? [part + sign, h("wbr")] : [part]));
}

/** Return the parameters of the fields; one that cannot be read is refused. */
function readFields(fields) {
  try {
    return valuesOf(fields);
  } catch (error) {
    refusals.add(error, {});
    return undefined;
  }
}

async function readYaml(text) {
  try {
    return (await send("POST", "/workspace/parameters", text)).params;
  } catch (error) {
    refusals.add(error, {});
    return undefined;
  }
}

customElements.define("st-controllers", Controllers);
