// Cameras: their newest pictures, or why there are none. A folded dock asks for none.
import { api, h, html, Panel, peek, press, store } from "../lib/panel.js";

const LOOK_MS = 30;
const AGAIN_MS = 5000; // after a picture that did not come

customElements.define("st-cameras", class CameraWall extends Panel {
  build() {
    this.cameras = [];
    store.addEventListener("docks", () => this.list());
    // One after the other: a browser has few connections, and other docks need some.
    this.every(LOOK_MS, async () => {
      for (const camera of this.cameras) if (performance.now() >= camera.dueAt) await this.look(camera);
    });
  }

  /** Ask a station once for its cameras; the workspace hides the dock while there are none. */
  async list() {
    const { boot_id: bootId } = store.docks;
    if (bootId === this.bootId) return;
    this.bootId = bootId;
    const answer = await peek("/cameras");
    if (!answer) this.bootId = ""; // asked again
    this.cameras = (answer?.cameras ?? []).map((camera) => ({ ...camera, dueAt: 0, picture: this.pictureOf(camera), large: false }));
    this.refresh();
  }

  pictureOf({ name, width, height }) {
    return h("img", { width, height, alt: `What the camera ${name} sees` });
  }

  /** Show a picture once it is there whole, in the place of the one before. */
  async look(camera) {
    camera.dueAt = performance.now() + 1000 / camera.rate;
    const next = this.pictureOf(camera);
    next.src = `/api/v1/cameras/${camera.name}?at=${Math.round(camera.dueAt)}`;
    try {
      await next.decode();
      Object.assign(camera, { picture: next, fault: "", isDrawn: true });
    } catch {
      camera.dueAt += AGAIN_MS;
      const { cameras } = await api("GET", "/cameras");
      camera.fault = cameras.find(({ name }) => name === camera.name)?.fault || "No picture came.";
    }
    this.refresh();
  }

  view() {
    const enlarge = (camera) => {
      camera.large = !camera.large;
      this.refresh();
    };
    return html`<div class="wall">${this.cameras.map((camera) => html`<figure class=${camera.large ? "large" : ""}>
      ${camera.picture}
      <figcaption><b>${camera.name}</b> ${camera.frame ? `on ${camera.frame}` : ""} ${press("large", "", () => enlarge(camera), { pressed: camera.large, name: `Show the camera ${camera.name} large` })}
        ${camera.fault ? html`<span class="fault" role="status">✖ ${camera.fault}</span>` : camera.isDrawn ? "" : "The first picture takes some seconds."}</figcaption>
    </figure>`)}</div>`;
  }
});
