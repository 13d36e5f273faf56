// Controllers: a row for each, what a switch would do before the click, chains, and loading.
import "./load_form.js";
import { act, api, breakable, button, figure, h, html, live, nothing, number, Panel, peek, render, repeat, restartController, shortNames, show, stopController, store, switchTo } from "../lib/panel.js";

const SYMBOLS = { running: "●", initialized: "○", stopped: "○", loading: "…", aborted: "✖", waiting: "…" };

const STEP = 5e-5; // smaller ones are none [unit of the command]
const SIGNS = { Restart: "↻", Unload: "✕" };

customElements.define("st-controllers", class Controllers extends Panel {
  build() {
    this.tools.append(button("Load …", undefined, () => this.form.toggle()));
    this.chains = h("div", {});
    const heads = ["controller", "state", "claims", "update", ""].map((text) => h("th", {}, text));
    heads[3].title = "Median time that an update takes in the control cycle; 99 of 100 in the tooltip of each cell";
    this.body = h("tbody", {});
    this.looks = 0;
    for (const name of ["pointermove", "pointerdown"]) this.addEventListener(name, ({ clientX, clientY }) => (this.pointer = { clientX, clientY }));
    this.preview = h("p", { class: "hint preview", role: "status" }, "Point at Start to see what a switch stops. After a start, this line says how far each joint stepped.");
    this.form = h("st-load-form", { class: "form", hidden: true });
    const table = h("table", { class: "controllers" }, h("thead", {}, h("tr", {}, ...heads)), this.body);
    this.append(this.preview, this.form, this.chains, h("div", { class: "scroll" }, table));
  }

  refresh() {
    // What moves the robot comes first, and in the order of loading: a row that changed its
    // place when it is started would lie under a pointer that meant another one.
    const rank = (c) => (c.resources.length ? 0 : 1);
    const rows = [...store.docks.controllers].sort((a, b) => rank(a) - rank(b));
    render(repeat(rows, (c) => c.name, (c) => this.row(c)), this.body);
    const states = store.docks.controllers.map((c) => `${c.name} ${c.state}`).join();
    if (states !== this.states) this.drawChains(states);
  }

  /** Show who commands whose references, in the order of their updates. */
  async drawChains(states) {
    this.states = states;
    const answer = await peek("/controllers/chains");
    if (!answer) return (this.states = ""); // asked again
    const drawn = new Map(answer.controllers.map((c) => [c.name, `${c.state === "running" ? "●" : "○"} ${c.name}${c.is_in_chained_mode ? " (chained)" : ""}`]));
    const link = ({ name, following }) => html`<p class="hint">${drawn.get(name)} → ${following.map((each) => drawn.get(each) ?? each).join(", ")}</p>`;
    return render(answer.controllers.filter(({ following }) => following.length).map(link), this.chains);
  }

  row(c) {
    const whenRunning = [
      { label: "Stop", title: `Stop ${c.name}; its joints hold`, run: () => stopController(c.name) },
      { label: "Restart", title: `Stop ${c.name} and start it again`, run: () => restartController(c.name), look: () => this.say(`Restart ${c.name}: its joints hold, and it starts anew from where they are.`), needs: "motion" },
    ];
    const otherwise = [
      { label: "Start", title: c.reason || `Start ${c.name}`, run: () => this.start(c), look: () => this.look(c), needs: "motion" },
      { label: "Unload", title: `Unload ${c.name}`, run: () => act("DELETE", `/controllers/${c.name}`).then(() => store.refresh()) },
    ];
    const actions = c.state === "running" ? whenRunning : otherwise;
    const p99 = c.update_count ? `p99 ${number(c.update_p99 * 1e6, 0)} µs, ${c.update_count} updates` : "It has not run yet";
    const claims = c.claims_short.map((claim) => html`<div>${claim.replace("-", "\u2011")}</div>`);
    // A button that means something else is another one: a held Enter must not press it.
    return html`<tr class=${c.state}>
      <th scope="row" title=${`${c.name}\n${c.type}`}>${breakable(c.name, "_")}<small>${breakable(c.type, "/")}</small>${c.fault ? html`<div class="fault">✖ ${c.fault}</div>` : nothing}</th>
      <td class="state" title=${c.state}>${SYMBOLS[c.state] ?? "○"} ${c.state === "initialized" ? "ready" : c.state}</td>
      <td class="claims" title=${c.claims}>${claims}</td>
      <td class="update" title=${p99}>${c.update_count ? `${number(c.update_p50 * 1e6, 0)} µs` : "–"}</td>
      <td class="actions">${repeat(actions, ({ label }) => label, (action) => this.button(c, action))}</td>
    </tr>`;
  }

  button(c, { label, title, run, look, needs = "change" }) {
    // A button that was drawn anew under a pointer at rest is entered, too.
    const enter = ({ clientX, clientY }) => (clientX !== this.pointer?.clientX || clientY !== this.pointer.clientY) && look();
    return html`<button class=${label === "Start" ? "s primary" : "s"} type="button" title=${title} aria-label="${label} ${c.name}" .rule=${{ needs }} ?disabled=${live(!store.can(needs))}
      @click=${run} @focus=${look} @pointerenter=${look && enter}>${SIGNS[label] ?? label}</button>`;
  }

  /** Say something that is newer than what is asked for. */
  say(text) {
    this.looks += 1;
    show(this.preview, text);
  }

  async start(c) {
    const done = await switchTo(c.name);
    const steps = done && stepsOf(done.jump, c.command_units);
    if (done) this.say(`Started ${c.name}${steps ? `: ${steps}` : ""}.`);
  }

  /** Ask the station what a switch would do; nothing is done. */
  async look(c) {
    this.looks += 1;
    const { looks } = this;
    const stop = store.controller(c.name)?.replaces ?? [];
    const words = ({ stopped, jump }) => `: stops ${stopped.join(", ") || "nothing"}; ${stepsOf(jump, c.command_units) || "the steps of the joints are known when it runs"}.`;
    const text = await api("POST", "/controllers/switch", { start: [c.name], stop, dry_run: true })
      .then(words, (error) => ` would be refused: ${error.detail ?? error.message} ${error.remedy ?? ""}`);
    // The pointer is at another button by now: only the newest answer is shown.
    if (looks === this.looks) show(this.preview, `Start ${c.name}${text}`);
  }
});

/** Return how far each joint steps, e.g. `joint1 0.0012 rad, joint2 −0.5 rad; 5 others not`. */
function stepsOf(jump, unitOf) {
  const names = shortNames(store.docks.joints);
  const known = Object.entries(jump).filter(([, size]) => size != null);
  if (!known.length) return "";
  const steps = known.filter(([, size]) => Math.abs(size) >= STEP);
  if (!steps.length) return "no joint steps";
  const still = known.length - steps.length;
  const texts = steps.map(([joint, size]) => `${names.get(joint) ?? joint} ${figure(size, unitOf[joint] ?? "", 4)}`.trim());
  return `steps ${texts.join(", ")}${still ? `; ${still} others none` : ""}`;
}
