// Timeline: what happened, recordings and incidents, as far as the station offers them.
import { alarmRows, alarms } from "../lib/alarms.js";
import { h, show } from "../lib/dom.js";
import { hideGhost, showGhost } from "../lib/ghost.js";
import { deedOf } from "../lib/deeds.js";
import { Panel } from "../lib/panel.js";
import { act, api, follow } from "../lib/station.js";
import { store } from "../lib/store.js";
import { html, nothing, render } from "../vendor/lit/lit-html.js";
import { repeat } from "../vendor/lit/directives/repeat.js";

const LOOK_MS = 2000;
const SHOWN = 60;
const KEPT = 500;
const SOURCES = [
  { id: "events", title: "Events" },
  { id: "alarms", title: "Alarms" },
  { id: "recordings", title: "Recordings" },
  { id: "incidents", title: "Incidents" },
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
    this.append(h("div", { class: "tabs" }, ...this.buttons, this.record), this.buildReplay(), this.list);
    store.addEventListener("marker", () => this.chosen === "events" && !this.offered && this.drawOwn());
    alarms.addEventListener("change", () => this.chosen === "alarms" && this.drawAlarms());
    this.events = new Map(); // by number: a frame may come twice after a reconnection
    this.choose("events");
    this.look();
    follow("events", "rate=10", (frame) => this.hear([frame.data]));
  }

  /** The time slider of a replay: it shows a second robot and cannot move the first. */
  buildReplay() {
    this.slider = h("input", { type: "range", min: 0, max: 1, step: 0.01, value: 0 });
    this.slider.setAttribute("aria-label", "Time of the replay");
    this.slider.addEventListener("input", () => this.showAt(Number(this.slider.value)));
    this.replayTime = h("output", {});
    this.run = h("button", { class: "s", type: "button", title: "Let the second robot move as recorded." }, "Play");
    this.run.addEventListener("click", () => this.runReplay());
    const end = h("button", { class: "s", type: "button" }, "End replay");
    end.addEventListener("click", () => this.endReplay());
    this.replayed = h("b", {});
    this.replay = h("div", { class: "line replay", hidden: true }, this.replayed, this.run, this.slider, this.replayTime, end, h("span", { class: "hint" }, "A picture in the 3D view; the robot does not move."));
    return this.replay;
  }

  async openReplay(name) {
    const told = await act("GET", `/${this.chosen}/${encodeURIComponent(name)}/trajectory?rate=30`);
    if (!told) return;
    this.endReplay();
    this.motion = told;
    this.replayed.textContent = name;
    this.slider.max = told.time.at(-1) - told.time[0];
    this.replay.hidden = false;
    this.showAt(0);
  }

  showAt(time) {
    const { name, time: times, position } = this.motion;
    let i = times.findIndex((each) => each - times[0] >= time);
    if (i < 0) i = times.length - 1;
    this.slider.value = time;
    const text = `${time.toFixed(1)} of ${Number(this.slider.max).toFixed(1)} s`;
    show(this.replayTime, text);
    showGhost(Object.fromEntries(name.map((joint, j) => [joint, position[i][j]]).filter(([, q]) => q !== null)), `recorded, ${text}`);
  }

  runReplay() {
    if (this.replayTimer) return this.pauseReplay();
    show(this.run, "Pause");
    const atEnd = Number(this.slider.value) >= Number(this.slider.max) - 0.01;
    const from = atEnd ? 0 : Number(this.slider.value);
    const began = performance.now();
    this.replayTimer = setInterval(() => {
      const time = from + (performance.now() - began) / 1000;
      this.showAt(Math.min(time, Number(this.slider.max)));
      if (time >= Number(this.slider.max)) this.pauseReplay();
    }, 50);
  }

  pauseReplay() {
    clearInterval(this.replayTimer);
    this.replayTimer = null;
    show(this.run, "Play");
  }

  endReplay() {
    this.pauseReplay();
    if (!this.replay.hidden) hideGhost();
    this.replay.hidden = true;
  }

  /** Keep events that have come, from the list or the stream, and show them. */
  hear(events) {
    for (const event of events) this.events.set(event.id, event);
    for (const id of [...this.events.keys()].sort((a, b) => a - b).slice(0, -KEPT)) this.events.delete(id);
    if (this.chosen === "events" && this.isShown) this.draw(this.inOrder());
  }

  inOrder() {
    return [...this.events.values()].sort((a, b) => a.id - b.id);
  }

  choose(id) {
    this.chosen = id;
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(button.dataset.id === id));
    this.tell("Asking the station …");
    this.ask();
  }

  async look() {
    if (this.isShown && !document.hidden) await this.ask();
    setTimeout(() => this.look(), LOOK_MS);
  }

  drawAlarms() {
    render(alarmRows(), this.list);
  }

  /** Show a sentence, and below it rows by their keys. */
  tell(text, rows = nothing) {
    render(html`${text ? html`<p class="hint">${text}</p>` : nothing}${rows}`, this.list);
  }

  async ask() {
    const id = this.chosen;
    if (id === "alarms") {
      this.record.hidden = true;
      return this.drawAlarms();
    }
    try {
      const path = id === "events" ? `/events?limit=${SHOWN}` : `/${id}`;
      const told = await api("GET", path, undefined, { Accept: "application/json" });
      if (id !== this.chosen) return;
      this.offered = true;
      this.record.hidden = id !== "recordings" || !store.isOperator;
      if (id === "events") this.hear(told.events);
      else this.draw(told.recordings);
    } catch (error) {
      if (id !== this.chosen || error.status === 0 || error.status >= 500) return; // The strip says so.
      if (error.status !== 404) return this.tell(`${error.detail} ${error.remedy}`);
      this.offered = false;
      this.record.hidden = true;
      this.drawOwn();
    }
  }

  /** Show what this page has noticed itself; the station keeps no such list. */
  drawOwn() {
    const what = SOURCES.find((source) => source.id === this.chosen).title;
    const notes = this.chosen === "events" ? [...store.markers].reverse().slice(0, SHOWN) : [];
    const rows = notes.map(({ at, text }) => html`<div class="row"><time>${at.toFixed(1)} s</time>${text}</div>`);
    const since = this.chosen === "events" ? " Below is what this page has noticed since it was opened, in station time." : "";
    this.tell(`${what}: not offered by this station.${since}`, rows);
  }

  draw(items) {
    if (this.chosen === "recordings") {
      this.running = items.find((item) => item.state === "recording")?.identifier;
      show(this.record, this.running ? "Stop recording" : "Record");
    }
    const shown = (this.chosen === "events" ? folded(items) : items).slice(-SHOWN);
    const rows = repeat(shown.reverse(), (item) => item.first ?? item.identifier, (item) => this.row(item));
    this.tell(shown.length ? "" : `No ${this.chosen} yet.`, rows);
  }

  row(item) {
    const at = new Date(item.started_at ?? item.time * 1e3);
    const row = (content) => html`<div class="row ${item.severity ?? ""}" title=${JSON.stringify(item, null, 1)}><time title=${at.toISOString()}>${at.toLocaleTimeString("en-GB")}</time>${content}</div>`;
    if (this.chosen === "events") {
      const sign = { warning: "▲ ", error: "✖ " }[item.severity] ?? "";
      const since = item.times > 1 ? ` (${item.times} alike since ${new Date(item.since * 1e3).toLocaleTimeString("en-GB")})` : "";
      const deed = deedOf(item);
      const who = item.who && !deed.includes(item.who) ? html`<b>${item.who} </b>` : nothing;
      return row(html`${who}<span>${sign}${deed}${since}</span>`);
    }
    const name = item.identifier;
    const size = `${(item.size / 1e6).toFixed(1)} MB, ${item.duration.toFixed(1)} s`;
    const lost = item.lost ? `${item.lost} cycles lost` : "";
    const what = [item.name || name, item.state, size, lost, ...(item.causes ?? []), item.error].filter(Boolean).join(" · ");
    // The file is whole once the recording has ended; until then there is nothing to load.
    if (item.state === "recording") return row(html`<span>${what}</span>`);
    const file = `/api/v1/${this.chosen}/${encodeURIComponent(name)}/file`;
    return row(html`<span>${what} </span><a href=${file} download="${name}.mcap">download</a>
      <button class="s" type="button" title="Show the recorded motion as a second robot in the 3D view." aria-label="Replay ${name}" @click=${() => this.openReplay(name)}>Replay</button>`);
  }

  async toggleRecording() {
    if (this.running) await act("POST", `/recordings/${this.running}/stop`);
    else await act("POST", "/recordings", {});
    this.ask();
  }
}

/** Return events with those that repeat one after the other as one: the newest, how often, and since when. */
function folded(events) {
  const found = [];
  for (const event of events) {
    const last = found.at(-1);
    const isAlike = last && ["kind", "what", "who", "severity"].every((key) => event[key] === last[key]);
    if (isAlike && (event.kind === "overrun" || event.text === last.text)) found[found.length - 1] = { ...event, times: last.times + 1, since: last.since, first: last.first };
    else found.push({ ...event, times: 1, since: event.time, first: event.id });
  }
  return found;
}

customElements.define("st-timeline", Timeline);
