// The slider of a joint: where the joint is within its limits, what it is told, and a thumb.
import { h, number } from "./panel.js";

const GRAB = 12; // pixels beside the thumb that belong to it
const SEND_MS = 50; // between two places of a drag
/** Keyboard steps [rad], [m]: an arrow key, with Shift, and Page Up or Down. */
const STEPS = { rad: { usual: Math.PI / 180, fine: Math.PI / 1800, coarse: Math.PI / 18 }, m: { usual: 0.001, fine: 0.0001, coarse: 0.01 } };
const KEYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -1, PageUp: 1 };
/** The ends of a joint without limits [rad], [m]. */
const ENDS = { rad: 2 * Math.PI, m: 1 };

/**
 * A slider that follows its joint while nobody holds it. `move(target)` takes the places of a
 * drag and of keys, `pick(target)` a click beside the thumb, and `show(target)` what a drag
 * means before the joint is there, null at its end.
 */
export class JointSlider {
  constructor({ label, limits, unit, move, pick, show }) {
    Object.assign(this, { unit, move, pick, show });
    [this.low, this.high] = limits ?? [-ENDS[unit], ENDS[unit]];
    this.held = null; // the place of the thumb while a pointer holds it
    this.wanted = null; // what keys asked for, until the joint is told so
    this.command = null;
    this.here = h("i", { class: "here", title: "Where the joint is" });
    this.mark = h("i", { class: "command", title: "Commanded position" });
    this.thumb = h("i", { class: "thumb" });
    const [ariaValueMin, ariaValueMax] = [this.low, this.high];
    const title = "Drag the thumb, or use the arrow keys; with Shift in finer steps, with Page Up and Down in coarser ones. A click beside it goes there.";
    const pointer = { onpointerdown: (event) => this.grab(event), onpointermove: (event) => this.drag(event), onpointerup: () => this.letGo(), onpointercancel: () => this.end(), onlostpointercapture: () => this.end() };
    this.element = h("div", { class: "slider", role: "slider", tabIndex: 0, title, ariaLabel: `Slider of ${label}`, ariaValueMin, ariaValueMax, onkeydown: (event) => this.press(event), ...pointer }, this.mark, this.here, this.thumb);
  }

  set disabled(disabled) {
    if (disabled) this.end();
    this.isDisabled = disabled;
    this.element.ariaDisabled = disabled;
  }

  clamp(value) {
    return Math.min(Math.max(value, this.low), this.high);
  }

  /** The place of a value, from 0 to 1. */
  part(value) {
    return (this.clamp(value) - this.low) / (this.high - this.low);
  }

  valueAt(clientX) {
    const { left, width } = this.element.getBoundingClientRect();
    return this.clamp(this.low + ((clientX - left) / width) * (this.high - this.low));
  }

  press(event) {
    const sign = KEYS[event.key];
    if (!sign || this.isDisabled || this.command === null) return;
    event.preventDefault();
    const steps = STEPS[this.unit];
    const step = event.key.startsWith("Page") ? steps.coarse : event.shiftKey ? steps.fine : steps.usual;
    // From what was asked for before: the joint may still be on its way there.
    this.wanted = this.clamp((this.wanted ?? this.command) + sign * step);
    this.move(this.wanted);
  }

  grab(event) {
    if (event.button !== 0 || this.isDisabled || this.command === null) return;
    const thumb = this.thumb.getBoundingClientRect();
    const away = event.clientX - (thumb.left + thumb.width / 2);
    this.wanted = null;
    if (Math.abs(away) > GRAB) return this.pick(this.valueAt(event.clientX));
    this.element.setPointerCapture(event.pointerId);
    this.offset = away; // the thumb does not jump under the pointer
    this.held = this.command;
    this.element.classList.add("held");
  }

  drag(event) {
    if (this.held === null) return;
    const value = this.valueAt(event.clientX - this.offset);
    if (value === this.held) return;
    this.held = value;
    this.draw();
    this.show(value);
    clearTimeout(this.later);
    const wait = SEND_MS - (performance.now() - (this.sentAt ?? 0));
    this.later = setTimeout(() => this.send(), Math.max(wait, 0));
  }

  send() {
    if (this.held === null) return;
    this.sentAt = performance.now();
    this.move(this.held);
    this.sent = this.held;
  }

  letGo() {
    if (this.held === null) return;
    if (this.sent !== this.held && this.held !== this.command) this.send();
    this.wanted = this.held;
    this.end();
  }

  /** End a drag; what was sent last stays asked for. */
  end() {
    if (this.held === null) return;
    clearTimeout(this.later);
    this.held = null;
    this.element.classList.remove("held");
    this.show(null);
  }

  /**
   * Show where the joint is and what it is told, or null, in [rad] or [m]; `isGoing` says that
   * it is still on its way there, and `text` is what the value is called.
   */
  update(position, command, isGoing, text) {
    this.position = position;
    this.command = command;
    if (!isGoing) this.wanted = null;
    this.element.setAttribute("aria-valuenow", number(command ?? position, 6));
    this.element.setAttribute("aria-valuetext", text);
    this.draw();
  }

  draw() {
    const place = (mark, value) => (mark.style.left = `${this.part(value) * 100}%`);
    place(this.here, this.position ?? this.low);
    this.mark.hidden = this.command === null;
    if (this.command !== null) place(this.mark, this.command);
    place(this.thumb, this.held ?? this.wanted ?? this.command ?? this.position ?? this.low);
  }
}
