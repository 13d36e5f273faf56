// Small pieces of the page that every panel uses, templates among them.
import { html, nothing, render } from "../vendor/lit/lit-html.js";
import { live } from "../vendor/lit/directives/live.js";
import { repeat } from "../vendor/lit/directives/repeat.js";
import { store } from "./store.js";
import { typed } from "./text.js";

export { html, live, nothing, render, repeat };

/** Return an element: `h("button", {class: "s", onclick: f}, "text", child)`. */
export function h(tag, props = {}, ...children) {
  const made = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined) continue;
    if (key === "class") made.className = value;
    else if (key === "data") Object.assign(made.dataset, value);
    // As a listener: a property's handler that returns false would bar what the key or click does.
    else if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key in made) made[key] = value;
    else if (value !== false && value != null) made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child != null));
  return made;
}

// The rule of a button: `needs` is what the station has to permit, as `store.can` knows it, and
// `off` says of its own, as a value or a function, that it can do nothing.
const isIdle = ({ needs, off }) => !store.can(needs) || Boolean(typeof off === "function" ? off() : off);

/** Disable the buttons of the page that can do nothing now, and no others of those that have a rule. */
export function decide() {
  for (const each of document.querySelectorAll("button")) if (each.rule) each.disabled = isIdle(each.rule);
}
// After the handlers of panels: what is typed or chosen may be what a button waits for.
for (const name of ["click", "input", "change"]) addEventListener(name, decide);
for (const name of ["docks", "bar"]) store.addEventListener(name, () => queueMicrotask(decide));

/** Return a button with its rule, `needs` and `off`; `props` are more of its properties. */
export function button(label, title, run, { needs, off, ...props } = {}) {
  const rule = { needs, off };
  return Object.assign(h("button", { class: "s", type: "button", title, onclick: run, ...props }, label), { rule, disabled: isIdle(rule) });
}

/** Return a field for a number, `input`, and a label around it with its name and unit; `read()` is the number or null. */
export function field(name, value, unit, label = `${name} [${unit}]`, input = h("input", { class: "value", inputMode: "decimal", autocomplete: "off", ariaLabel: label })) {
  input.value = value;
  return { input, label: h("label", {}, `${name} `, input, ` ${unit}`), read: () => typed(input.value), put: (number) => (input.value = number) };
}

/**
 * Return a slider, `input`, and a label around it with `words` and its value as `textOf` says
 * it; `tell()` says it anew, and `changed` is called with a value that somebody has chosen.
 */
export function ranged(words, textOf, changed, props) {
  const heard = () => {
    tell();
    changed(Number(input.value));
  };
  const input = h("input", { type: "range", oninput: heard, ...props });
  const text = h("output", {});
  const tell = () => {
    show(text, textOf(Number(input.value)));
    input.ariaValueText = text.textContent;
  };
  tell();
  return { input, tell, label: h("label", { class: "speed" }, `${words} `, input, text) };
}

/** Return a field for a name that Enter sends. */
export const nameField = (label, placeholder, send, props = {}) => h("input", { class: "name", placeholder, ariaLabel: label, onkeydown: ({ key }) => key === "Enter" && send(), ...props });

/** Return a choice among texts, or pairs of value and text. */
export function choice(label, choices, changed, props = {}) {
  const made = h("select", { ariaLabel: label, onchange: changed, ...props });
  offer(made, choices);
  return made;
}

/** Return a row of parts. */
export const line = (...parts) => h("div", { class: "line" }, ...parts);

/** Return a button with its rule for a template; one that stays down is `pressed`. */
export const press = (label, title, run, { look = "s", needs, off, pressed = nothing, name = nothing } = {}) =>
  html`<button class=${look} type="button" title=${title || nothing} aria-label=${name} aria-pressed=${pressed} .rule=${{ needs, off }} ?disabled=${live(isIdle({ needs, off }))} @click=${run}>${label}</button>`;

/** Set a text only when it differs, so that the browser has nothing to lay out. */
export function show(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/**
 * Offer choices, texts or pairs of value and text; the chosen one stays chosen, and an open
 * list stays open. Without any, `none` is shown and nothing can be chosen.
 */
export function offer(select, choices, none = "none saved yet") {
  const pairs = choices.length ? choices.map((choice) => [choice].flat()) : [["", none]];
  const key = JSON.stringify(pairs);
  if (key === select.offered) return;
  select.offered = key;
  const chosen = select.value;
  render(repeat(pairs, ([value]) => value, ([value, text = value]) => html`<option value=${value}>${text}</option>`), select);
  if (pairs.some(([value]) => String(value) === chosen)) select.value = chosen;
  select.disabled = !choices.length;
}

/** Return a long name, for a template, that may be broken after a sign and nowhere else. */
export function breakable(text, sign) {
  return text.split(sign).map((part, i) => (i ? html`${sign}<wbr>${part}` : part));
}

/**
 * A field for a number that is sent with Enter. What nobody has typed is only shown, so that
 * Enter on it sends nothing; `input.edited` says whether somebody has. `changed` is told when
 * a value is typed or left.
 */
export function valueField(label, send, changed = () => {}) {
  const edit = (edited) => () => {
    input.edited = edited;
    changed();
  };
  const enter = ({ key }) => key === "Enter" && input.edited && send();
  const input = h("input", { class: "value", inputMode: "decimal", autocomplete: "off", spellcheck: false, ariaLabel: label, oninput: edit(true), onblur: edit(false), onkeydown: enter, onfocus: () => input.select() });
  // A second click would put the caret into a value that is only shown or was sent, and
  // what is typed then would become one number with it. What is being typed keeps its caret.
  // The browser collapses a selection that is clicked only after `click`, so its own way is barred.
  input.addEventListener("mousedown", (event) => {
    if (input.edited) return;
    event.preventDefault();
    input.focus();
    input.select();
  });
  return input;
}

/**
 * A button that acts while it is held, by pointer or with the Enter key. One that is
 * disabled meanwhile, e.g. by a stop, has to be pressed anew.
 */
export function holdButton(label, title, hold, release) {
  const button = h("button", { class: "s hold", type: "button", title, ariaLabel: title }, label);
  let timer = null;
  const end = () => {
    if (timer === null) return;
    clearInterval(timer);
    timer = null;
    button.classList.remove("held");
    release();
  };
  const begin = () => {
    if (timer !== null || button.disabled) return;
    button.classList.add("held");
    hold();
    timer = setInterval(() => (button.isConnected ? hold() : end()), 100);
  };
  new MutationObserver(() => button.disabled && end()).observe(button, { attributes: true, attributeFilter: ["disabled"] });
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    button.setPointerCapture(event.pointerId);
    begin();
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture", "blur"])
    button.addEventListener(name, end);
  button.addEventListener("keydown", (event) => {
    if (event.key === "Enter" && !event.repeat) begin();
    if (event.key === "Enter") event.preventDefault();
  });
  button.addEventListener("keyup", (event) => event.key === "Enter" && end());
  window.addEventListener("blur", end);
  document.addEventListener("visibilitychange", end);
  return button;
}

/** Whether one dock is shown at a time, below the view. */
export const isNarrow = () => matchMedia("(max-width: 999px)").matches;

/** Keep something of this browser's user, e.g. the layout. */
export const kept = {
  get(key, fallback) {
    try {
      return JSON.parse(localStorage.getItem(`station.${key}`)) ?? fallback;
    } catch {
      return fallback;
    }
  },
  set(key, value) {
    try {
      localStorage.setItem(`station.${key}`, JSON.stringify(value));
    } catch {
      // A browser that keeps nothing shows the usual layout next time.
    }
  },
};
