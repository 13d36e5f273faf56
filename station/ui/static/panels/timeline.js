// Timeline: what happened, recordings and incidents, as far as the station offers them.
import { h, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { act, api } from "../lib/station.js";
import { store } from "../lib/store.js";

const LOOK_MS = 2000;
const SHOWN = 60;
const SOURCES = [
  { id: "events", title: "Events", key: "events" },
  { id: "recordings", title: "Recordings", key: "recordings" },
  { id: "incidents", title: "Incidents", key: "incidents" },
];

class Timeline extends Panel {
  build() {
    this.chosen = "events";
    this.buttons = SOURCES.map((source) => {
      const button = h("button", { class: "s", type: "button" }, source.title);
      button.addEventListener("click", () => this.choose(source.id));
      button.dataset.id = source.id;
      return button;
    });
    this.record = h("button", { class: "s", type: "button", hidden: true }, "Record");
    this.record.addEventListener("click", () => this.toggleRecording());
    this.list = h("div", { class: "log", tabIndex: 0 });
    this.list.setAttribute("aria-label", "What happened");
    this.append(h("div", { class: "line" }, ...this.buttons, this.record), this.list);
    store.addEventListener("marker", () => this.chosen === "events" && !this.offered && this.drawOwn());
    this.choose("events");
    this.look();
  }

  choose(id) {
    this.chosen = id;
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(button.dataset.id === id));
    this.list.replaceChildren(h("p", { class: "hint" }, "Asking the station …"));
    this.ask();
  }

  async look() {
    if (this.isShown && !document.hidden) await this.ask();
    setTimeout(() => this.look(), LOOK_MS);
  }

  async ask() {
    const id = this.chosen;
    try {
      const told = await api("GET", `/${id}`, undefined, { Accept: "application/json" });
      if (id !== this.chosen) return;
      this.offered = true;
      this.record.hidden = id !== "recordings" || !store.isOperator;
      this.draw(told[id] ?? told.items ?? []);
    } catch (error) {
      if (error.status !== 404 || id !== this.chosen) return;
      this.offered = false;
      this.record.hidden = true;
      this.drawOwn();
    }
  }

  /** Show what this page has noticed itself; the station keeps no such list. */
  drawOwn() {
    const what = SOURCES.find((source) => source.id === this.chosen).title;
    const notes = this.chosen === "events" ? [...store.markers].reverse().slice(0, SHOWN) : [];
    const rows = notes.map(({ at, text }) => h("div", { class: "row" }, h("time", {}, `${at.toFixed(1)} s`), text));
    const since = this.chosen === "events" ? " Below is what this page has noticed since it was opened, in station time." : "";
    this.list.replaceChildren(h("p", { class: "hint" }, `${what}: not offered by this station.${since}`), ...rows);
  }

  draw(items) {
    const key = JSON.stringify(items.slice(-SHOWN));
    if (key === this.drawn) return;
    this.drawn = key;
    const rows = items.slice(-SHOWN).reverse().map((item) => this.row(item));
    this.list.replaceChildren(...(rows.length ? rows : [h("p", { class: "hint" }, `No ${this.chosen} yet.`)]));
  }

  row(item) {
    const when = item.time ?? item.at ?? item.started_at ?? item.wall_time ?? item.stamp ?? "";
    const time = typeof when === "string" && when.includes("T") ? when.split("T")[1].slice(0, 8) : typeof when === "number" && when > 1e9 ? new Date(when * 1e3).toLocaleTimeString("en-GB") : String(when);
    const actor = item.actor ?? item.who ?? item.owner ?? "";
    const text = [item.kind ?? item.type ?? item.name ?? item.id, item.text ?? item.message ?? item.detail ?? item.reason ?? item.cause, item.result].filter((part) => typeof part === "string" && part).join(" · ");
    const name = item.id ?? item.name;
    const link = this.chosen !== "events" && name != null ? h("a", { href: `/api/v1/${this.chosen}/${encodeURIComponent(name)}/file`, download: "" }, "download") : null;
    return h("div", { class: "row", title: JSON.stringify(item, null, 1) }, h("time", {}, time), actor ? h("b", {}, `${actor} `) : null, h("span", {}, text), link);
  }

  async toggleRecording() {
    const stopping = this.record.textContent === "Stop recording";
    if (await act("POST", `/recordings/${stopping ? "stop" : "start"}`, {})) show(this.record, stopping ? "Record" : "Stop recording");
    this.ask();
  }
}

customElements.define("st-timeline", Timeline);
