// Who holds control, and how to take it, hand it over and give it back. The lease itself
// stays in the gateway; this page only learns who holds control and whether it does.
import { html, kept, nothing, press, refusals, render, said, send, show, store } from "./panel.js";

const LOOK_MS = 1000;
const PATH = "/workspace/control";

const element = (id) => document.getElementById(id);
const note = (text) => html`<p class="hint">${text}</p>`;
const button = (label, run, look = "") => press(label, "", run, { look: `s ${look}` });

class Control {
  state = { owner: null, mine: false };
  asking = false;
  changes = 0; // how often this page asked for a change, or had its answer

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
    const { owner } = state;
    // Control has gone to somebody else, or nobody, without this page giving it back.
    if (this.state.mine && !state.mine) {
      const detail = owner ? `${owner} has taken control.` : "Control has expired: the station heard nothing from this dashboard.";
      refusals.add({ code: "control_held", detail, remedy: owner ? "Your changes are refused until control is yours again." : "Take it again before you go on." });
    }
    this.state = state;
    this.draw();
  }

  open({ asking = false }) {
    this.asking = asking && !this.state.mine;
    this.panel.hidden = false;
    element("control").ariaExpanded = "true";
    this.draw();
    // Who has said a name, here or at the login, is not asked again.
    this.panel.querySelector(kept.get("person", "") ? "button" : "input, button")?.focus();
  }

  close() {
    this.panel.hidden = true;
    this.asking = false;
    element("control").ariaExpanded = "false";
  }

  /** Ask the station; a refusal goes into the log. Returns whether it was done. */
  async ask(method, body) {
    this.changes += 1;
    const state = await said(send(method, PATH, body), { method, path: PATH });
    if (!state) return false;
    this.changes += 1;
    Object.assign(this, { state, asking: false });
    this.draw();
    return true;
  }

  async take(force, owner = this.panel.querySelector("input[name=owner]")?.value.trim() ?? "") {
    kept.set("person", owner);
    if (await this.ask("POST", { owner, force })) this.close();
  }

  draw() {
    const { owner, mine } = this.state;
    show(element("control"), owner === null ? "any operator" : mine ? `you (${owner})` : owner);
    element("control").dataset.held = owner === null ? "" : mine ? "mine" : "other";
    const watching = element("watching");
    const holder = mine ? "" : (owner ?? "");
    watching.hidden = !holder || !store.isOperator;
    render(html`<span>${owner} holds control: here you only watch. STOP works.</span> ${button("Take control …", () => this.open({ asking: true }))}`, watching);
    const isOther = holder !== store.holder;
    store.holder = holder;
    if (isOther && store.docks) store.dispatchEvent(new Event("docks")); // buttons can do less, or more
    if (!this.panel.hidden) render(html`<h2>Control</h2>${this.content()}`, this.panel);
  }

  content() {
    const { owner, mine, since, hand_over_to: heir } = this.state;
    const at = new Date(since * 1e3).toLocaleTimeString("en-GB");
    const close = button("Close", () => this.close());
    const offer = (to) => to && this.ask("PATCH", { hand_over_to: to });
    if (!store.isOperator) return html`${note(owner === null ? "Nobody holds control: every operator may change things." : `${owner} holds control.`)}<div class="line">${close}</div>`;
    if (mine)
      return html`${note(`You hold control as ${owner} since ${at}. The changes of others are refused; anybody can stop.`)}
        <div class="line">${button("Give back", () => this.ask("DELETE"), "primary")}<label>Hand over to <input class="name" name="heir" maxlength="100" /></label>${button("Offer", () => offer(this.panel.querySelector("input[name=heir]").value.trim()))}${close}</div>
        ${heir ? note(`Offered to ${heir}, who can take control now. Until then it stays yours.`) : nothing}`;
    if (owner === null)
      return html`${note("Nobody holds control: every operator may change things. Once you take it, the changes of all others are refused until you give it back or this page is closed.")}
        <div class="line">${this.nameField()}${button("Take control", () => this.take(false), "primary")}${close}</div>`;
    if (this.asking)
      return html`${note(`Take control away from ${owner}? What ${owner} is moving is held where it is, and ${owner} is told your name.`)}
        <div class="line">${this.nameField()}${button(`Yes, take it from ${owner}`, () => this.take(true), "danger")}${button("No", () => this.close())}</div>`;
    return html`${note(`${owner} holds control since ${at}: your changes are refused. STOP always works.${heir ? ` Control is offered to ${heir}.` : ""}`)}
      <div class="line">${heir ? button(`Take control as ${heir}`, () => this.take(false, heir), "primary") : nothing}${button("Take it by force …", () => this.open({ asking: true }))}${close}</div>`;
  }

  nameField() {
    const enter = ({ key }) => key === "Enter" && !this.asking && this.take(false);
    return html`<label>Your name <input class="name" name="owner" maxlength="100" value=${kept.get("person", "")} placeholder="e.g. ada" @keydown=${enter} /></label>`;
  }
}

export const control = new Control();
