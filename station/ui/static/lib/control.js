// Who holds control, and how to take it, hand it over and give it back. The lease itself
// stays in the gateway; this page only learns who holds control and whether it does.
import { button as plainButton, h, kept, show } from "./dom.js";
import { refusals } from "./refusals.js";
import { Refusal, send } from "./station.js";
import { store } from "./store.js";

const LOOK_MS = 1000;
const PATH = "/workspace/control";

const element = (id) => document.getElementById(id);
const button = (label, run, kind = "") => plainButton(label, undefined, run, { class: `s ${kind}` });

class Control {
  constructor() {
    this.state = { owner: null, mine: false };
    this.asking = false;
    this.drawn = "";
    this.changes = 0; // how often this page asked for a change, or had its answer
  }

  start() {
    this.panel = element("control-panel");
    element("control").addEventListener("click", () => (this.panel.hidden ? this.open({}) : this.close()));
    store.addEventListener("bar", () => this.draw());
    this.look();
  }

  async look() {
    const changes = this.changes;
    try {
      const state = await send("GET", PATH);
      // A look that overlaps a change of this page may show what was before it.
      if (changes === this.changes) this.heard(state);
    } catch {
      show(element("control"), "–"); // The strip says that the station does not answer.
    }
    setTimeout(() => this.look(), document.hidden ? 2000 : LOOK_MS);
  }

  heard(state) {
    if (this.state.mine && !state.mine) this.lost(state);
    this.state = state;
    this.draw();
  }

  /** Control has gone to somebody else, or nobody, without this page giving it back. */
  lost({ owner }) {
    const detail = owner ? `${owner} has taken control.` : "Control has expired: the station heard nothing from this dashboard.";
    refusals.add({ code: "control_held", detail, remedy: owner ? "Your changes are refused until control is yours again." : "Take it again before you go on." });
  }

  open({ asking = false }) {
    this.asking = asking && !this.state.mine;
    this.panel.hidden = false;
    element("control").setAttribute("aria-expanded", "true");
    this.drawn = "";
    this.draw();
    // Who has said a name, here or at the login, is not asked again.
    this.panel.querySelector(kept.get("person", "") ? "button" : "input, button")?.focus();
  }

  close() {
    this.panel.hidden = true;
    this.asking = false;
    element("control").setAttribute("aria-expanded", "false");
  }

  /** Ask the station; a refusal goes into the log. Returns whether it was done. */
  async ask(method, body) {
    this.changes += 1;
    try {
      const state = await send(method, PATH, body);
      this.changes += 1;
      this.state = state;
      this.asking = false;
      this.drawn = "";
      this.draw();
      return true;
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      refusals.add(error, { method, path: PATH });
      return false;
    }
  }

  async take(force, owner = this.panel.querySelector("input[name=owner]")?.value.trim() ?? "") {
    kept.set("person", owner);
    if (await this.ask("POST", { owner, force })) this.close();
  }

  draw() {
    const { owner, mine, hand_over_to: heir } = this.state;
    show(element("control"), owner === null ? "any operator" : mine ? `you (${owner})` : owner);
    element("control").dataset.held = owner === null ? "" : mine ? "mine" : "other";
    const watching = element("watching");
    watching.hidden = owner === null || mine || !store.isOperator;
    show(watching, `${owner} holds control: here you only watch. STOP works.`);
    const key = JSON.stringify([owner, mine, heir, this.asking, store.isOperator]);
    if (this.panel.hidden || key === this.drawn) return;
    this.drawn = key;
    this.panel.replaceChildren(h("h2", {}, "Control"), ...this.content());
  }

  content() {
    const { owner, mine } = this.state;
    const line = (...parts) => h("div", { class: "line" }, ...parts);
    const note = (text) => h("p", { class: "hint" }, text);
    if (!store.isOperator)
      return [note(owner === null ? "Nobody holds control: every operator may change things." : `${owner} holds control.`), line(button("Close", () => this.close()))];
    if (mine) return this.contentOfHolder(line, note);
    if (owner === null)
      return [
        note("Nobody holds control: every operator may change things. Once you take it, the changes of all others are refused until you give it back or this page is closed."),
        line(this.nameField(), button("Take control", () => this.take(false), "primary"), button("Close", () => this.close())),
      ];
    return this.contentOfOthers(line, note);
  }

  contentOfHolder(line, note) {
    const { owner, since, hand_over_to: heir } = this.state;
    const to = h("input", { class: "name", name: "heir", maxLength: 100, ariaLabel: "Hand over to" });
    const offer = async () => to.value.trim() && (await this.ask("PATCH", { hand_over_to: to.value.trim() }));
    const at = new Date(since * 1e3).toLocaleTimeString("en-GB");
    return [
      note(`You hold control as ${owner} since ${at}. The changes of others are refused; anybody can stop.`),
      line(
        button("Give back", () => this.ask("DELETE"), "primary"),
        h("label", {}, "Hand over to ", to),
        button("Offer", offer),
        button("Close", () => this.close()),
      ),
      ...(heir ? [note(`Offered to ${heir}, who can take control now. Until then it stays yours.`)] : []),
    ];
  }

  contentOfOthers(line, note) {
    const { owner, since, hand_over_to: heir } = this.state;
    const at = new Date(since * 1e3).toLocaleTimeString("en-GB");
    const close = button("Close", () => this.close());
    if (this.asking)
      return [
        note(`Take control away from ${owner}? What ${owner} is moving is held where it is, and ${owner} is told your name.`),
        line(this.nameField(), button(`Yes, take it from ${owner}`, () => this.take(true), "danger"), button("No", () => this.close())),
      ];
    const ask = button("Take it by force …", () => this.open({ asking: true }));
    const accept = heir ? button(`Take control as ${heir}`, () => this.take(false, heir), "primary") : null;
    const offer = heir ? ` Control is offered to ${heir}.` : "";
    return [note(`${owner} holds control since ${at}: your changes are refused. STOP always works.${offer}`), line(accept, ask, close)];
  }

  nameField() {
    const field = h("input", { class: "name", name: "owner", maxLength: 100, value: kept.get("person", ""), placeholder: "e.g. ada" });
    field.addEventListener("keydown", (event) => event.key === "Enter" && !this.asking && this.take(false));
    return h("label", {}, "Your name ", field);
  }
}

export const control = new Control();
