// Controllers: a row for each, what a switch would do before the click, and loading.
import "./load_form.js";
import { breakable, h, number, shortNames, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { act, api } from "../lib/station.js";
import { restartController, stopController, store, switchTo } from "../lib/store.js";

const SYMBOLS = { running: "●", initialized: "○", stopped: "○", loading: "…", aborted: "✖", waiting: "…" };

const STEP = 5e-5; // smaller ones are none [unit of the command]
const SIGNS = { Restart: "↻", Unload: "✕" };

class Controllers extends Panel {
  build() {
    const load = h("button", { class: "s", type: "button" }, "Load …");
    load.addEventListener("click", () => this.form.toggle());
    this.tools.append(load);
    const heads = ["controller", "state", "claims", "update", ""].map((text) => h("th", {}, text));
    heads[3].title = "Median time that an update takes in the control cycle; 99 of 100 in the tooltip of each cell";
    this.body = h("tbody", {});
    this.looks = 0;
    for (const name of ["pointermove", "pointerdown"]) this.addEventListener(name, ({ clientX, clientY }) => (this.pointer = { clientX, clientY }));
    this.preview = h("p", { class: "hint preview", role: "status" }, "Point at Start to see what a switch stops. After a start, this line says how far each joint stepped.");
    this.form = h("st-load-form", { class: "form", hidden: true });
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
      // What moves the robot comes first, and in the order of loading: a row that changed its
      // place when it is started would lie under a pointer that meant another one.
      const rank = (c) => (c.resources.length ? 0 : 1);
      const rows = [...store.docks.controllers].sort((a, b) => rank(a) - rank(b));
      this.isDrawing = true;
      this.body.replaceChildren(...rows.map((c) => this.row(c)));
      if (focused) this.body.querySelector(`[data-key="${CSS.escape(focused)}"]`)?.focus();
      this.isDrawing = false;
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
      if (look) {
        made.addEventListener("focus", () => this.isDrawing || look());
        made.addEventListener("pointerenter", (event) => this.isPointedAt(event) && look());
      }
      return made;
    };
    const update = h("td", { class: "update" });
    this.cells.set(c.name, update);
    const actions =
      c.state === "running"
        ? [
            button("Stop", `Stop ${c.name}; its joints hold`, () => stopController(c.name)),
            button("Restart", `Stop ${c.name} and start it again`, () => restartController(c.name), () => this.say(`Restart ${c.name}: its joints hold, and it starts anew from where they are.`)),
          ]
        : [
            button("Start", c.reason || `Start ${c.name}`, () => this.start(c), () => this.look(c)),
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

  /** Whether a pointer came to a button: one that was drawn anew under a pointer at rest is entered, too. */
  isPointedAt({ clientX, clientY }) {
    return clientX !== this.pointer?.clientX || clientY !== this.pointer.clientY;
  }

  /** Say something that is newer than what is asked for. */
  say(text) {
    this.looks += 1;
    show(this.preview, text);
  }

  async unload(c) {
    await act("DELETE", `/controllers/${c.name}`);
    await store.refresh();
  }

  async start(c) {
    const done = await switchTo(c.name);
    if (!done) return;
    const steps = stepsOf(done.jump, c.command_units);
    this.say(`Started ${c.name}${steps ? `: ${steps}` : ""}.`);
  }

  /** Ask the station what a switch would do; nothing is done. */
  async look(c) {
    this.looks += 1;
    const { looks } = this;
    const stop = store.controller(c.name)?.replaces ?? [];
    let text;
    try {
      const plan = await api("POST", "/controllers/switch", { start: [c.name], stop, dry_run: true });
      const stops = plan.stopped.length ? `stops ${plan.stopped.join(", ")}` : "stops nothing";
      text = `Start ${c.name}: ${stops}; ${stepsOf(plan.jump, c.command_units) || "the steps of the joints are known when it runs"}.`;
    } catch (error) {
      text = `Start ${c.name} would be refused: ${error.detail ?? error.message} ${error.remedy ?? ""}`;
    }
    // The pointer is at another button by now: only the newest answer is shown.
    if (looks === this.looks) show(this.preview, text);
  }
}

/** Return how far each joint steps, e.g. `joint1 0.0012 rad, joint2 −0.5 rad; 5 others not`. */
function stepsOf(jump, units) {
  const names = shortNames(store.docks.joints);
  const known = Object.entries(jump).filter(([, size]) => size != null);
  if (!known.length) return "";
  const steps = known.filter(([, size]) => Math.abs(size) >= STEP);
  if (!steps.length) return "no joint steps";
  const still = known.length - steps.length;
  const texts = steps.map(([joint, size]) => `${names.get(joint) ?? joint} ${Number(size.toFixed(4))} ${units[joint] ?? ""}`.trim());
  return `steps ${texts.join(", ")}${still ? `; ${still} others none` : ""}`;
}

customElements.define("st-controllers", Controllers);
