// Waypoint paths: captured, edited and played at the station, so they outlive this page.
import { Forecast } from "../lib/forecast.js";
import { hideGhost, showGhost, ticking } from "../lib/ghost.js";
import { act, api, choice, h, html, live, nameField, number, offer, Panel, press, Refusal, refusals, render, repeat, sharedPrefix, store, switchTo, typed } from "../lib/panel.js";

const LOOK_MS = 250;
const LIST_MS = 2000;
const FIRST_NAME = "path-1";

/** Return where the joints of a waypoint are now. */
const here = ({ positions }) => Object.fromEntries(Object.keys(positions).map((joint) => [joint, store.positionsOf([joint])[0]]));

customElements.define("st-path", class Path extends Panel {
  build() {
    this.path = { name: "", waypoints: [] };
    this.says = "Capture where the arm is, move it, capture again, then Play.";
    this.list = h("ol", { class: "waypoints" });
    this.choice = choice("Waypoint path", [], () => this.open(this.choice.value), { title: "Paths kept by the station." });
    this.newName = nameField("Name of a new path", "new path", () => this.make());
    this.speed = h("input", { type: "range", min: 10, max: 200, step: 5, value: 100, title: "Factor of all speeds of the path; also while it plays.", ariaLabel: "Speed of the path in percent", oninput: () => this.drawTools(), onchange: () => this.isActive && this.ask("PATCH", "/playback", { speed: this.factor }) });
    this.forecast = new Forecast();
    this.drawTools();
    this.every(LOOK_MS, () => this.look());
    // Both hands are at the arm while it is guided: one key, wherever the focus is.
    addEventListener("keydown", ({ key, target, repeat }) => {
      const isFree = !repeat && !target.matches?.("input:not([type=range]), textarea, select");
      if (key === "c" && isFree && this.guided && store.can("change")) this.capture();
    });
  }

  /** Draw everything but the waypoints. */
  drawTools() {
    const { playback, isActive } = this;
    const may = store.can("change");
    const isEmpty = !this.path.waypoints.length;
    const [isPaused, isPreview] = [playback?.state === "paused", Boolean(this.stopPreview)];
    render(html`<div class="line">${this.choice}${this.newName}
        ${press("New", "Begin a path of this name", () => this.make(), { needs: "change", off: () => !this.newName.value.trim() })}
        ${press("Delete", "Delete the chosen path from the station", () => this.remove(), { needs: "change", off: () => !this.choice.value })}</div>
      <div class="line">
        ${press("+ Capture", "Keep the present joints as the next waypoint", () => this.capture(), { needs: "change" })}
        ${press("Preview", "Let a translucent robot pass the waypoints; the robot does not move", () => this.preview(), { pressed: isPreview, off: isEmpty })}
        ${press("Rehearse", "Try one round in a copy of the station: how it would end, and a ghost of it. Nothing moves.", () => this.forecast.rehearsePath(this.path, { speed: this.factor }), { needs: "change", off: isEmpty })}
        ${press("▶ Play", "Move through all waypoints in order", () => this.play(), { look: "s primary", needs: "motion", off: isEmpty })}
        ${press(isPaused ? "Resume" : "Pause", "Hold where the arm is; Resume goes on", () => this.ask("PATCH", "/playback", { paused: !isPaused }), { needs: isPaused ? "motion" : "change", off: !isActive })}
        ${press("Cancel", "End the motion; the joints hold where they are", () => this.ask("DELETE", "/playback"), { needs: "change", off: !isActive })}</div>
      <div class="line"><label class="speed">speed ${this.speed}<output>${this.speed.value} %</output></label>
        ${press("Loop", "Begin again at the end, until it is switched off", () => this.setLoop(), { pressed: Boolean(this.isLoop) })}
        <progress max="1" value=${playback?.progress ?? 0} ?hidden=${!isActive} aria-label="Progress of the path"></progress></div>
      ${this.forecast.element}${this.list}<p class="hint state" role="status">${this.says}</p>`, this);
  }

  /** The factor of all speeds that was chosen. */
  get factor() {
    return this.speed.value / 100;
  }

  /** Whether somebody guides an arm by hand. */
  get guided() {
    return store.isArmIn("guiding");
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
    const answer = await act("POST", `${this.url}/capture`, {});
    if (answer) {
      this.says = `Captured ${answer.waypoints.at(-1).name} of ${answer.name}.`;
      this.draw(answer);
    }
    this.read().catch(() => {});
  }

  /** Save changed waypoints; what the station refuses is shown as it was before. */
  async save(waypoints) {
    const answer = await act("PUT", this.url, { waypoints });
    this.drawn = null;
    if (answer) this.draw(answer);
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
    this.drawTools();
  }

  row(point, i) {
    const { waypoints } = this.path;
    const prefix = sharedPrefix(Object.keys(point.positions));
    const change = (parts) => this.save(waypoints.with(i, { ...point, ...parts }));
    const tool = (label, title, run, rule = {}) => press(label, title, run, { needs: "change", name: `${title}: ${point.name}`, ...rule });
    // What was typed and refused is put back, so the field itself is compared.
    const field = (look, value, label, take) => html`<input class=${look} .value=${live(value)} aria-label=${label}
      @change=${({ target }) => { target.blur(); take(target); }} @keydown=${({ key, target }) => key === "Enter" && target.blur()}>`;
    const name = field("name", point.name, `Name of waypoint ${i + 1}`, (input) => change({ name: input.value }));
    const seconds = field("value", String(point.duration), `Seconds to ${point.name}`, (input) => {
      const duration = typed(input.value);
      if (duration !== null) return change({ duration });
      refusals.add({ code: "not_a_number", detail: `“${input.value}” is not a number.`, remedy: "Type seconds, such as 1.5." });
      input.value = String(point.duration);
    });
    const swap = (j) => () => this.save(waypoints.with(i, waypoints[j]).with(j, point));
    const set = tool("Set", "Replace by where the arm is now", () => change({ positions: here(point) }));
    const title = Object.entries(point.positions).map(([joint, q]) => `${joint.slice(prefix.length)}: ${number(q, 4)}`).join("\n");
    // A waypoint is shown as a ghost while the pointer or the focus is on its button.
    const isFree = () => !this.stopPreview;
    const look = () => isFree() && showGhost(point.positions, `waypoint ${point.name}`);
    const leave = () => isFree() && hideGhost();
    return html`<li title=${title}>${name}${seconds} s
      <span @pointerover=${look} @focusin=${look} @pointerout=${leave} @focusout=${leave}>${tool("Go", "Move to this waypoint", () => this.play(i), { needs: "motion" })}</span>${set}${tool("↑", "Move up", swap(i - 1), { off: i === 0 })}${tool("↓", "Move down", swap(i + 1), { off: i === waypoints.length - 1 })}${tool("✕", "Remove", () => this.save(waypoints.toSpliced(i, 1)))}
    </li>`;
  }

  /** Let the ghost pass the waypoints once, straight between them, at the chosen speed. */
  preview() {
    if (this.stopPreview) return this.endPreview();
    const { waypoints } = this.path;
    const start = here(waypoints[0]);
    this.stopPreview = ticking((seconds) => {
      let time = seconds * this.factor;
      let from = start;
      for (const { name, duration, positions } of waypoints) {
        const between = ([joint, q]) => [joint, from[joint] + (time / duration) * (q - from[joint])];
        if (time < duration) return showGhost(Object.fromEntries(Object.entries(positions).map(between)), `preview, to ${name}`);
        time -= duration;
        from = { ...from, ...positions };
      }
      return this.endPreview();
    });
    this.drawTools();
  }

  endPreview() {
    this.stopPreview();
    this.stopPreview = null;
    this.drawTools();
    hideGhost();
  }

  /** Play the path, or with `only` go to one waypoint; starts a controller if none runs. */
  async play(only) {
    const body = { speed: this.factor, loop: only === undefined && Boolean(this.isLoop) };
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
      await this.ask("POST", path, body);
    }
  }

  setLoop() {
    this.isLoop = !this.isLoop;
    this.drawTools();
    if (this.isActive) this.ask("PATCH", "/playback", { loop: this.isLoop });
  }

  async ask(method, path, body) {
    const answer = await act(method, path, body);
    if (answer) this.showPlayback(answer);
  }

  async look() {
    this.showPlayback((await api("GET", "/playback")).playback);
    if (performance.now() - this.readAt < LIST_MS) return;
    this.readAt = performance.now();
    await this.read();
  }

  showPlayback(playback) {
    this.playback = playback;
    if (playback) this.describe(playback);
    this.drawTools();
  }

  /** Say how far a path has come. */
  describe(playback) {
    if (this.isActive) this.isLoop = playback.loop;
    const rounds = playback.loop || playback.rounds > 1 ? ` · round ${playback.rounds + 1}` : "";
    const where = `waypoint ${playback.waypoint + 1} of ${playback.waypoints}${rounds}`;
    const texts = {
      playing: `${playback.path}: to ${where} · ${number(playback.remaining, 1)} s left · ${playback.controller}`,
      paused: `${playback.path}: paused on the way to ${where}.`,
      succeeded: "The motion succeeded.",
      cancelled: "The motion was cancelled; the joints hold.",
      aborted: `The motion was aborted: ${playback.message}`,
    };
    if (playback.state !== this.shownState || this.isActive) this.says = texts[playback.state];
    this.shownState = playback.state;
  }
});
