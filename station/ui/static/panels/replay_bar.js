// The bar of an open recording over the plots: time, play, speed, comparison, notes, link.
// Its `tools` belong beside the title of the dock.
import { button, choice, h, html, line, nameField, nothing, number, press, render, show } from "../lib/panel.js";
import { replay } from "../lib/replay.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];
const BEGIN = "begin";

customElements.define("st-replay-bar", class ReplayBar extends HTMLElement {
  connectedCallback() {
    if (this.slider) return;
    this.hidden = true;
    this.play = button("Play", "Let the ghost in the 3D view move as recorded; the robot does not move.", () => (replay.isPlaying ? replay.pause() : replay.play()), { off: () => !replay.isOpen });
    this.slider = h("input", { type: "range", min: 0, max: 1, step: 0.001, value: 0, ariaLabel: "Time of the replay", oninput: () => replay.seek(Number(this.slider.value)) });
    this.time = h("output", {});
    this.speed = choice("Speed of the replay", SPEEDS.map((speed) => [speed, `× ${speed}`]), () => (replay.speed = Number(this.speed.value)), { title: "Speed of the replay." });
    this.speed.value = "1";
    this.runs = h("div", { class: "runs" });
    this.noteButton = button("Note", "Write a note into the recording, on this moment or on the range that the plots show.", () => this.openNote(), { needs: "change", off: () => replay.runs[0]?.kind === "experiments" }); // a trial is no file
    const link = button("Copy link", "Copy a link that opens this recording at this moment, with these plots.", () => this.copyLink(link));
    const end = button("End replay", "Close the recording; the plots go on with the robot.", () => replay.close());
    this.text = nameField("Text of the note", "What happened?", () => this.addNote(), { class: "", type: "text", maxLength: 500 });
    this.place = h("select", { ariaLabel: "What the note is on" });
    this.form = line(this.text, this.place, button("Add note", "It stays in the file.", () => this.addNote()));
    this.tools = h("span", { class: "replay-tools", hidden: true }, this.noteButton, link, end);
    this.append(line(this.play, this.slider, this.time, this.speed), this.runs, this.form);
    replay.addEventListener("change", () => this.draw());
    replay.addEventListener("runs", () => this.drawRuns());
    this.drawRuns();
  }

  draw() {
    this.hidden = !replay.isOpen && !replay.reading;
    this.tools.hidden = !replay.isOpen;
    this.slider.max = replay.duration;
    this.slider.value = replay.time;
    show(this.play, replay.isPlaying ? "Pause" : "Play");
    show(this.time, replay.reading || `${number(replay.time, 2)} of ${number(replay.duration, 2)} s`);
  }

  drawRuns() {
    this.form.hidden = true;
    const [first, ...others] = replay.runs;
    const events = (run) => [html`<option value=${BEGIN}>begin</option>`, ...run.events.map(({ time, text, kind }, i) => html`<option value=${i}>${number(time - run.begin, 2)} s ${text || kind}</option>`)];
    const timeOf = (run, select) => (select.value === BEGIN ? run.begin : run.events[Number(select.value)].time);
    const align = (event, run) => {
      const [own, of] = event.target.closest(".run").querySelectorAll("select");
      replay.align(run, timeOf(run, own), timeOf(first, of));
    };
    const other = (run) => html`<span class="run"><b>B</b><span title=${run.id}>${run.name}</span>
      <label>its <select aria-label="Moment of B" @change=${(event) => align(event, run)}>${events(run)}</select></label>
      <label>at A’s <select aria-label="Moment of A" @change=${(event) => align(event, run)}>${events(first)}</select></label>
      ${press("✕", "", () => replay.drop(run), { name: "Compare no longer" })}</span>`;
    const compare = () => this.dispatchEvent(new Event("compare-live"));
    const live = first && !others.length ? press("Compare with the last minute", "Lay what the robot has done in the last minute over the recording.", compare) : nothing;
    render(first ? html`<span class="run">${others.length ? html`<b>A</b>` : nothing}<span title=${first.id}>${first.name}</span></span>${others.map(other)}${live}` : nothing, this.runs);
    this.draw();
  }

  openNote() {
    this.form.hidden = !this.form.hidden;
    if (this.form.hidden) return;
    this.range = this.shown();
    const [begin, end] = this.range.map((time) => number(time, 2));
    this.place.replaceChildren(h("option", { value: "moment" }, `at ${number(replay.time, 2)} s`), h("option", { value: "range" }, `from ${begin} to ${end} s, as shown`));
    // Who has zoomed means the part that is shown.
    this.place.value = this.range[1] - this.range[0] < replay.duration * 0.98 ? "range" : "moment";
    this.text.focus();
  }

  async addNote() {
    const text = this.text.value.trim();
    if (!text) return this.text.focus();
    const [begin, end] = this.place.value === "range" ? this.range : [replay.time, null];
    if (await replay.addNote(text, begin, end)) this.text.value = "";
  }

  async copyLink(button) {
    const link = replay.link(this.layout());
    const done = await navigator.clipboard?.writeText(link).then(() => true, () => false);
    // Over plain HTTP from another machine a page may not write to the clipboard.
    if (!done) return prompt("Link to this moment:", link);
    show(button, "Copied");
    return setTimeout(() => show(button, "Copy link"), 1500);
  }
});
