// The unit of angles that a person chose for this browser.
import { kept } from "./dom.js";
import { inDegrees } from "./text.js";

export const DEGREES = 180 / Math.PI;

class Units extends EventTarget {
  constructor() {
    super();
    this.angle = kept.get("angle", "deg");
  }

  /** Choose "deg" or "rad" for all docks. */
  choose(angle) {
    this.angle = angle;
    kept.set("angle", angle);
    this.dispatchEvent(new Event("change"));
  }

  /** The factor from radians to the chosen unit. */
  get scale() {
    return this.angle === "deg" ? DEGREES : 1;
  }

  /** Return a sentence of the station with its angles in the chosen unit. */
  words(text) {
    return this.angle === "deg" ? inDegrees(text) : text;
  }

  /** The chosen unit's sign. */
  get sign() {
    return this.angle === "deg" ? "°" : " rad";
  }
}

export const units = new Units();
