// Waypoint paths: captured, edited and played at the station, so they outlive this page.
import { Forecast } from "../lib/forecast.js";
import { hideGhost, showGhost } from "../lib/ghost.js";
import { button, h, html, line, live, offer, render, repeat, show } from "../lib/dom.js";
import { Panel } from "../lib/panel.js";
import { refusals } from "../lib/refusals.js";
import { act, api, Refusal } from "../lib/station.js";
import { store, switchTo } from "../lib/store.js";
import { number, sharedPrefix, typed } from "../lib/text.js";

const LOOK_MS = 250;
const LIST_MS = 2000;
const PREVIEW_MS = 60;
const FIRST_NAME = "path-1";

class Path extends Panel {
  build() {
    this.path = { name: "", waypoints: [] };
    this.list = h("ol", { class: "waypoints" });
    this.choice = h("select", { title: "Paths kept by the station.", ariaLabel: "Waypoint path", onchange: () => this.open(this.choice.value) });
    this.newName = h("input", { class: "name", placeholder: "new path", ariaLabel: "Name of a new path" });
    this.newName.addEventListener("keydown", (event) => event.key === "Enter" && this.make());
    this.newName.addEventListener("input", () => this.showPlayback(this.playback));
    this.newButton = button("New", "Begin a path of this name", () => this.make());
    this.deleteButton = button("Delete", "Delete the chosen path from the station", () => this.remove());
    this.captureButton = button("+ Capture", "Keep the present joints as the next waypoint", () => this.capture());
    this.playButton = button("▶ Play", "Move through all waypoints in order", () => this.play(), { class: "s primary" });
    this.previewButton = button("Preview", "Let a translucent robot pass the waypoints; the robot does not move", () => this.preview());
    this.previewButton.setAttribute("aria-pressed", "false");
    this.forecast = new Forecast();
    this.rehearseButton = button("Rehearse", "Try one round in a copy of the station: how it would end, and a ghost of it. Nothing moves.", () => this.forecast.rehearsePath(this.path, { speed: this.speed.value / 100 }));
    this.pauseButton = button("Pause", "Hold where the arm is; Resume goes on", () => this.change({ paused: this.playback.state === "playing" }));
    this.cancelButton = button("Cancel", "End the motion; the joints hold where they are", () => this.cancel());
    this.loop = button("Loop", "Begin again at the end, until it is switched off", () => this.setLoop());
    this.loop.setAttribute("aria-pressed", "false");
    this.speed = h("input", { type: "range", min: 10, max: 200, step: 5, value: 100, title: "Factor of all speeds of the path; also while it plays.", ariaLabel: "Speed of the path in percent" });
    this.speedText = h("output", {}, "100 %");
    this.speed.addEventListener("input", () => show(this.speedText, `${this.speed.value} %`));
    this.speed.addEventListener("change", () => this.isActive && this.change({ speed: this.speed.value / 100 }));
    this.progress = h("progress", { max: 1, value: 0, hidden: true, ariaLabel: "Progress of the path" });
    this.state = h("p", { class: "hint state", role: "status" }, "Capture where the arm is, move it, capture again, then Play.");
    this.append(
      line(this.choice, this.newName, this.newButton, this.deleteButton),
      line(this.captureButton, this.previewButton, this.rehearseButton, this.playButton, this.pauseButton, this.cancelButton),
      line(h("label", { class: "speed" }, "speed ", this.speed, this.speedText), this.loop, this.progress),
      this.forecast.element,
      this.list,
      this.state,
    );
    this.showPlayback(null);
    this.every(LOOK_MS, () => this.look());
    // Both hands are at the arm while it is guided: one key, wherever the focus is.
    addEventListener("keydown", ({ key, target, repeat }) => {
      const isFree = !repeat && !target.matches?.("input:not([type=range]), textarea, select");
      if (key === "c" && isFree && this.guided && store.isOperator) this.capture();
    });
  }

  /** Whether somebody guides an arm by hand. */
  get guided() {
    return store.docks?.arms.some((arm) => arm.robot_mode === "guiding");
  }

  get isActive() {
    return ["playing", "paused"].includes(this.playback?.state);
  }

  get url() {
    return `/waypoint-paths/${encodeURIComponent(this.path.name || FIRST_NAME)}`;
  }

  /** List the paths, and show the one that is chosen; somebody else may have changed it. */
  async read() {
    const { waypoint_paths: names } = await api("GET", "/waypoint-paths");
    if (this.path.name && !names.includes(this.path.name) && !this.path.waypoints.length) names.push(this.path.name);
    offer(this.choice, names);
    const wanted = names.includes(this.path.name) ? this.path.name : names[0];
    this.choice.value = wanted ?? "";
    if (!wanted) return this.draw({ name: "", waypoints: [] });
    // A path that has just been named is saved with its first waypoint.
    await this.open(wanted);
  }

  async open(name) {
    try {
      this.draw(await api("GET", `/waypoint-paths/${encodeURIComponent(name)}`));
    } catch (error) {
      if (error.status !== 404) throw error;
      this.draw({ name, waypoints: [] });
    }
  }

  make() {
    const name = this.newName.value.trim().replace(/\s+/g, "-");
    if (!name) return this.newName.focus();
    this.newName.value = "";
    this.draw({ name, waypoints: [] });
    this.read().catch(() => {});
  }

  async capture() {
    const told = await act("POST", `${this.url}/capture`, {});
    if (told) this.draw(told);
    if (told) show(this.state, `Captured ${told.waypoints.at(-1).name} of ${told.name}.`);
    this.read().catch(() => {});
  }

  /** Save changed waypoints; what the station refuses is shown as it was before. */
  async save(waypoints) {
    const told = await act("PUT", this.url, { waypoints });
    this.drawn = null;
    if (told) this.draw(told);
    else await this.open(this.path.name);
  }

  async remove() {
    if (!this.choice.value) return;
    await act("DELETE", this.url);
    this.path = { name: "", waypoints: [] };
    this.read().catch(() => {});
  }

  draw(path) {
    const text = JSON.stringify(path);
    if (text === this.drawn || (path.name === this.path.name && this.list.contains(document.activeElement) && document.activeElement.matches("input"))) return;
    this.drawn = text;
    this.path = path;
    const focused = document.activeElement;
    const key = ({ name }, i) => (path.waypoints.findIndex((other) => other.name === name) === i ? name : `${name} ${i}`);
    render(repeat(path.waypoints, key, (point, i) => this.row(point, i)), this.list);
    // A row that has changed its place has lost the focus.
    if (this.list.contains(focused)) focused.focus();
    this.showPlayback(this.playback);
  }

  row(point, i) {
    const { waypoints } = this.path;
    const prefix = sharedPrefix(Object.keys(point.positions));
    const changed = (change) => waypoints.map((other, j) => (j === i ? { ...other, ...change } : other));
    const tool = (label, title, run, disabled = false) => html`<button class="s" type="button" title=${title} aria-label="${title}: ${point.name}" ?disabled=${disabled || !store.isOperator} @click=${run}>${label}</button>`;
    // What was typed and refused is put back, so the field itself is compared.
    const field = (look, value, label, change) => html`<input class=${look} .value=${live(value)} aria-label=${label}
      @change=${({ target }) => { target.blur(); change(target); }} @keydown=${({ key, target }) => key === "Enter" && target.blur()}>`;
    const name = field("name", point.name, `Name of waypoint ${i + 1}`, (input) => this.save(changed({ name: input.value })));
    const seconds = field("value", String(point.duration), `Seconds to ${point.name}`, (input) => {
      const duration = typed(input.value);
      if (duration === null) {
        refusals.add({ code: "not_a_number", detail: `“${input.value}” is not a number.`, remedy: "Type seconds, such as 1.5." });
        input.value = String(point.duration);
      } else this.save(changed({ duration }));
    });
    const swap = (j) => () => {
      const moved = [...waypoints];
      [moved[i], moved[j]] = [moved[j], moved[i]];
      this.save(moved);
    };
    const set = () => {
      const positions = Object.fromEntries(Object.keys(point.positions).map((joint) => [joint, store.joints.position[store.joints.name.indexOf(joint)]]));
      this.save(changed({ positions }));
    };
    const title = Object.entries(point.positions).map(([joint, q]) => `${joint.slice(prefix.length)}: ${number(q, 4)}`).join("\n");
    // A waypoint is shown as a ghost while the pointer or the focus is on its button.
    const isFree = () => !this.previewTimer;
    const look = () => isFree() && showGhost(point.positions, `waypoint ${point.name}`);
    const leave = () => isFree() && hideGhost();
    return html`<li title=${title}>${name}${seconds} s
      <span @pointerover=${look} @focusin=${look} @pointerout=${leave} @focusout=${leave}>${tool("Go", "Move to this waypoint", () => this.play(i))}</span>${tool("Set", "Replace by where the arm is now", set)}${tool("↑", "Move up", swap(i - 1), i === 0)}${tool("↓", "Move down", swap(i + 1), i === waypoints.length - 1)}${tool("✕", "Remove", () => this.save(waypoints.filter((_, j) => j !== i)))}
    </li>`;
  }

  /** Let the ghost pass the waypoints once, straight between them, at the chosen speed. */
  preview() {
    if (this.previewTimer) return this.endPreview();
    const { waypoints } = this.path;
    const here = Object.fromEntries(Object.keys(waypoints[0].positions).map((joint) => [joint, store.joints.position[store.joints.name.indexOf(joint)]]));
    const began = performance.now();
    this.previewButton.setAttribute("aria-pressed", "true");
    this.previewTimer = setInterval(() => {
      let time = ((performance.now() - began) / 1000) * (this.speed.value / 100);
      let from = here;
      for (const { name, duration, positions } of waypoints) {
        if (time < duration) return showGhost(blend(from, positions, time / duration), `preview, to ${name}`);
        time -= duration;
        from = { ...from, ...positions };
      }
      this.endPreview();
    }, PREVIEW_MS);
  }

  endPreview() {
    clearInterval(this.previewTimer);
    this.previewTimer = null;
    this.previewButton.setAttribute("aria-pressed", "false");
    hideGhost();
  }

  /** Play the path, or with `only` go to one waypoint; starts a controller if none runs. */
  async play(only) {
    const body = { speed: this.speed.value / 100, loop: only === undefined && this.loop.getAttribute("aria-pressed") === "true" };
    if (only !== undefined) Object.assign(body, { first: only, last: only });
    const path = `${this.url}/play`;
    try {
      this.showPlayback(await api("POST", path, body));
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      const wanted = error.details.controllers?.[0];
      if (!wanted) return refusals.add(error, { method: "POST", path, body });
      // The switch says what was in its way; the path waits for the controller to run.
      if (!(await switchTo(wanted))) return;
      const told = await act("POST", path, body);
      if (told) this.showPlayback(told);
    }
  }

  setLoop() {
    const loop = this.loop.getAttribute("aria-pressed") !== "true";
    this.loop.setAttribute("aria-pressed", String(loop));
    if (this.isActive) this.change({ loop });
  }

  async change(change) {
    const told = await act("PATCH", "/playback", change);
    if (told) this.showPlayback(told);
  }

  async cancel() {
    const told = await act("DELETE", "/playback");
    if (told) this.showPlayback(told);
  }

  async look() {
    this.showPlayback((await api("GET", "/playback")).playback);
    if (performance.now() - this.readAt < LIST_MS) return;
    this.readAt = performance.now();
    await this.read();
  }

  showPlayback(playback) {
    this.playback = playback;
    const active = this.isActive;
    this.pauseButton.disabled = this.cancelButton.disabled = !active || !store.isOperator;
    this.captureButton.disabled = !store.isOperator;
    this.newButton.disabled = !store.isOperator || !this.newName.value.trim();
    this.deleteButton.disabled = !store.isOperator || !this.choice.value;
    this.playButton.disabled = !store.isOperator || !this.path.waypoints.length;
    this.rehearseButton.disabled = this.playButton.disabled;
    this.previewButton.disabled = !this.path.waypoints.length;
    show(this.pauseButton, playback?.state === "paused" ? "Resume" : "Pause");
    this.progress.hidden = !active;
    if (!playback) return;
    this.progress.value = playback.progress;
    if (active) this.loop.setAttribute("aria-pressed", String(playback.loop));
    const rounds = playback.loop || playback.rounds > 1 ? ` · round ${playback.rounds + 1}` : "";
    const where = `waypoint ${playback.waypoint + 1} of ${playback.waypoints}${rounds}`;
    const texts = {
      playing: `${playback.path}: to ${where} · ${number(playback.remaining, 1)} s left · ${playback.controller}`,
      paused: `${playback.path}: paused on the way to ${where}.`,
      succeeded: "The motion succeeded.",
      cancelled: "The motion was cancelled; the joints hold.",
      aborted: `The motion was aborted: ${playback.message}`,
    };
    if (playback.state !== this.shownState || active) show(this.state, texts[playback.state]);
    this.shownState = playback.state;
  }
}

/** Return positions between two others, at a part from 0 to 1 of the way. */
function blend(from, to, part) {
  return Object.fromEntries(Object.entries(to).map(([joint, q]) => [joint, from[joint] + part * (q - from[joint])]));
}

customElements.define("st-path", Path);
