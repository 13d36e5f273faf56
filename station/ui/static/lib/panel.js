// The base of all panels: a custom element that draws when the page's knowledge changes. Panels
// and the modules beside them import from here what all of them work with.
import { render } from "./dom.js";
import { Refusal } from "./station.js";
import { store } from "./store.js";

export * from "./dom.js";
export * from "./refusals.js";
export * from "./station.js";
export * from "./store.js";
export * from "./text.js";
export * from "./units.js";

export class Panel extends HTMLElement {
  connectedCallback() {
    if (this.built) return;
    this.built = true;
    this.build();
    store.addEventListener("docks", () => this.isShown && this.refresh());
  }

  /** The place for buttons beside the title of the dock. */
  get tools() {
    return this.previousElementSibling.querySelector(".tools");
  }

  /** Whether the dock is open; a folded dock draws nothing. */
  get isShown() {
    return this.offsetParent !== null;
  }

  /** Build the elements, once. */
  build() {}

  /** Draw what has changed: what the panel's `view()` returns, a template. */
  refresh() {
    if (this.view) render(this.view(), this);
  }

  /** Call `look` again and again, the next time so long after its end, while the dock is open. */
  async every(ms, look) {
    // The strip says when the station is lost; the next look may reach it.
    if (this.isShown && !document.hidden && store.docks) await Promise.resolve(look()).catch((error) => error instanceof Refusal || console.error(error));
    setTimeout(() => this.every(ms, look), ms);
  }
}
