// The unit of angles that a person chose for this browser.
import { field, kept, show } from "./dom.js";
import { inDegrees, number } from "./text.js";

export const DEGREES = 180 / Math.PI;

class Units extends EventTarget {
  angle = kept.get("angle", "deg");

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

  /** Return the chosen unit for values in `unit`, such as rad/s, and the factor to it; other units stay. */
  shown(unit) {
    const isAngle = this.angle === "deg" && /^m?rad\b/.test(unit);
    return isAngle ? { unit: unit.replace(/m?rad/, "°"), scale: unit.startsWith("m") ? DEGREES / 1e3 : DEGREES } : { unit, scale: 1 };
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

/** Return a value with its unit, in the chosen one if it is an angle; a degree is more than a mrad, so it has more digits. */
export function figure(value, unit, digits) {
  const shown = units.shown(unit);
  return `${number(value * shown.scale, shown.scale < 1 ? digits + 1 : digits)} ${shown.unit}`;
}

/** Return a field for an angle [rad] in the chosen unit, around an `own` input if there is one; what nobody has typed stays exact. */
export function angleField(name, radians = null, label = name, own = undefined) {
  const { input, label: row, read } = field(name, "", "", label, own);
  const unit = row.appendChild(document.createElement("span"));
  let exact = radians;
  const put = (value) => {
    exact = value;
    input.value = value === null ? "" : Number(number(value * units.scale, units.scale > 1 ? 2 : 4));
  };
  const draw = () => {
    show(unit, units.sign);
    put(exact);
  };
  input.addEventListener("input", () => (exact = read() === null ? null : read() / units.scale));
  units.addEventListener("change", draw);
  draw();
  return { input, label: row, read: () => exact, put };
}
