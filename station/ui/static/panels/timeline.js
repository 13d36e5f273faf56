// Timeline: what happened, recordings and incidents, as far as the station offers them.
import { alarmRows, alarms } from "../lib/alarms.js";
import { act, api, button, follow, h, html, nothing, Panel, press, refusals, render, repeat, show, store, units } from "../lib/panel.js";
import { replay } from "../lib/replay.js";

const LOOK_MS = 2000;
const SHOWN = 60;
const KEPT = 500;
const MOST_UPLOADED = 500e6; // as the station takes [bytes]
const SOURCES = { events: "Events", alarms: "Alarms", recordings: "Recordings", incidents: "Incidents", experiments: "Experiments" };

customElements.define("st-timeline", class Timeline extends Panel {
  build() {
    this.chosen = "events";
    this.buttons = Object.entries(SOURCES).map(([id, title]) => button(title, undefined, () => this.choose(id), { data: { id } }));
    const record = () => (this.running ? act("POST", `/recordings/${this.running}/stop`) : act("POST", "/recordings", {}));
    this.record = button("Record", "Record every cycle, until it is clicked again.", () => record().then(() => this.ask()), { needs: "change" });
    this.file = h("input", { type: "file", accept: ".mcap", hidden: true, onchange: () => this.upload(this.file.files[0]) });
    this.uploadButton = button("Upload …", "Keep the .mcap file of this station or another one among the recordings.", () => this.file.click(), { needs: "change", off: () => this.isUploading });
    this.fileTools = h("span", { class: "file-tools", hidden: true }, this.record, this.uploadButton, this.file);
    this.list = h("div", { class: "log", tabIndex: 0, ariaLabel: "What happened" });
    this.append(h("div", { class: "tabs" }, ...this.buttons, this.fileTools), this.list);
    replay.addEventListener("runs", () => this.ask());
    alarms.addEventListener("change", () => this.chosen === "alarms" && this.tell("", alarmRows()));
    this.events = new Map(); // by number: a frame may come twice after a reconnection
    this.choose("events");
    this.every(LOOK_MS, () => this.ask());
    follow("events", "rate=10", (frame) => this.hear([frame.data]));
  }

  /** Keep events that have come, from the list or the stream, and show them in their order. */
  hear(events) {
    for (const event of events) this.events.set(event.id, event);
    this.events = new Map([...this.events].sort(([a], [b]) => a - b).slice(-KEPT));
    if (this.chosen === "events" && this.isShown) this.draw([...this.events.values()]);
  }

  choose(id) {
    this.chosen = id;
    for (const button of this.buttons) button.ariaPressed = button.dataset.id === id;
    this.tell("Asking the station …");
    this.ask();
  }

  /** Show a sentence, and below it rows by their keys. */
  tell(text, rows = nothing) {
    render(html`${text ? html`<p class="hint">${text}</p>` : nothing}${rows}`, this.list);
  }

  async ask() {
    const id = this.chosen;
    this.fileTools.hidden = id !== "recordings" || !store.isOperator;
    if (id === "alarms") return this.tell("", alarmRows());
    try {
      const path = id === "events" ? `/events?limit=${SHOWN}` : `/${id}`;
      const answer = await api("GET", path, undefined, { Accept: "application/json" });
      if (id !== this.chosen) return;
      if (id === "events") this.hear(answer.events);
      else if (id === "experiments") this.draw(answer.experiments.map((one) => ({ ...one, identifier: one.name, started_at: one.created_at })).sort((a, b) => a.started_at.localeCompare(b.started_at)));
      else this.draw(answer.recordings);
    } catch (error) {
      if (id !== this.chosen || error.status === 0 || error.status >= 500) return; // The strip says so.
      this.tell(`${error.detail} ${error.remedy}`);
    }
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
    const row = (content) => html`<div class="row ${item.severity ?? ""}" title=${JSON.stringify(item, null, 1)}><time title=${at.toISOString()}>${at.toDateString() === new Date().toDateString() ? "" : `${at.toLocaleDateString("en-GB", { weekday: "short", day: "numeric", month: "short" })} `}${at.toLocaleTimeString("en-GB")}</time>${content}</div>`;
    if (this.chosen === "events") {
      const sign = { warning: "▲ ", error: "✖ " }[item.severity] ?? "";
      const since = item.times > 1 ? ` (${item.times} alike since ${new Date(item.since * 1e3).toLocaleTimeString("en-GB")})` : "";
      const deed = units.words(item.text || `${item.kind} ${item.what} ${item.result}`);
      const who = item.who && !deed.includes(item.who) ? html`<b>${item.who} </b>` : nothing;
      return row(html`${who}<span>${sign}${deed}${since}</span>`);
    }
    const name = item.identifier;
    if (this.chosen === "experiments") {
      const failed = item.failed ? `${item.failed} failed` : "";
      const what = [name, item.kind, item.controller, item.state, `${item.ended} of ${item.trials} trials`, failed, item.reason].filter(Boolean).join(" · ");
      return row(html`<span>${what} </span>${item.ended ? this.openers(name, "Open the best trial in the plots, and that at the start over it; as a ghost in the 3D view.") : nothing}`);
    }
    const size = `${(item.size / 1e6).toFixed(1)} MB, ${item.duration.toFixed(1)} s`;
    const lost = item.lost ? `${item.lost} cycles lost` : "";
    const what = [item.name || name, item.is_uploaded ? "uploaded" : item.state, size, lost, ...(item.causes ?? []), item.error].filter(Boolean).join(" · ");
    // The file is whole once the recording has ended; until then there is nothing to load.
    if (item.state === "recording") return row(html`<span>${what}</span>`);
    const file = `/api/v1/${this.chosen}/${encodeURIComponent(name)}/file`;
    return row(html`<span>${what} </span><a href=${file} download="${name}.mcap">download</a> ${this.openers(name, "Open it in the plots, and as a ghost in the 3D view.")}`);
  }

  /** The buttons that open a recording or a trial in the plots. */
  openers(name, title) {
    const isOther = replay.isOpen && replay.runs[0].id.split(":")[0] !== name;
    return html`${press("Replay", title, () => this.open(name, false), { name: `Replay ${name}` })}
      ${isOther ? press("Compare", "Lay it over the recording that is open.", () => this.open(name, true), { name: `Compare with ${name}` }) : nothing}`;
  }

  async open(name, isOther) {
    window.dispatchEvent(new CustomEvent("show-dock", { detail: "plots" }));
    const kind = this.chosen;
    if (kind !== "experiments") return replay.open({ kind, id: name, isOther });
    const best = await replay.open({ kind, id: `${name}:best`, isOther });
    return best && !isOther && best.id.endsWith(":best") && replay.open({ kind, id: `${name}:first`, isOther: true });
  }

  /** Send a file to the station, which says why when it is none. */
  async upload(file) {
    this.file.value = "";
    if (!file) return;
    const size = Math.ceil(file.size / 1e6);
    if (file.size > MOST_UPLOADED) return refusals.add({ code: "body_too_large", detail: `${file.name} has ${size} MB; ${MOST_UPLOADED / 1e6} MB are taken at most.`, remedy: "Record less at a time." });
    // Without the time that the station which recorded it put before the name.
    const name = file.name.replace(/\.mcap$/i, "").replace(/^\d{8}T\d{9}-?/, "").replace(/^[^A-Za-z0-9_]+/, "").replace(/[^A-Za-z0-9_.-]+/g, "_").slice(0, 80);
    this.isUploading = true;
    show(this.uploadButton, `Uploading ${size} MB …`);
    await act("POST", `/recordings/upload?${new URLSearchParams({ name })}`, file);
    this.isUploading = false;
    show(this.uploadButton, "Upload …");
    await this.ask();
  }

});

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
