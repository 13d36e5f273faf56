// Numbers and names as people read and type them; needs no page.

export function number(value, digits) {
  if (value == null || !Number.isFinite(value)) return "–";
  const text = value.toFixed(digits);
  return /^-0\.?0*$/.test(text) ? text.slice(1) : text;
}

/** Return what all texts begin with, when there is more than one, e.g. `q joint`. */
export function commonStart(texts) {
  let shared = texts.length > 1 ? texts[0] : "";
  for (const text of texts) while (!text.startsWith(shared)) shared = shared.slice(0, -1);
  return shared;
}

/** Return what the joints' names share up to an underscore, e.g. `panda_`. */
export function sharedPrefix(names) {
  const shared = commonStart(names);
  return shared.slice(0, shared.lastIndexOf("_") + 1);
}

const SUFFIX = "_joint"; // says nothing where all joints have it

/** Return how to name each of these joints in few characters: a map by their names. */
export function shortNames(joints) {
  const prefix = sharedPrefix(joints);
  const suffixed = joints.every((joint) => joint.length > prefix.length + SUFFIX.length && joint.endsWith(SUFFIX));
  return new Map(joints.map((joint) => [joint, joint.slice(prefix.length, suffixed ? -SUFFIX.length : undefined)]));
}

const NUMBER = "(-?\\d+(?:\\.\\d+)?(?:e[-+]?\\d+)?)";
const ANGLES = new RegExp(`(?:${NUMBER}( to | and | and at most ))?${NUMBER} rad\\b(?!/?s? or m)`, "g");

/** Return a sentence with its angles in degrees: `1 to 2 rad/s` is `57.3 to 114.59°/s`. */
export function inDegrees(text) {
  const turned = (value) => String(Number(((value * 180) / Math.PI).toFixed(2)));
  return text.replace(ANGLES, (_, low, between, high) => `${low === undefined ? "" : turned(low) + between}${turned(high)}°`);
}

/** Return the range that a value has to be in, e.g. `above 0 to ∞`; nothing where there is none. */
export function rangeOf({ minimum, maximum, excludes_minimum: open }) {
  if (minimum == null && maximum == null) return "";
  return `${open ? "above " : ""}${minimum ?? "−∞"} to ${maximum ?? "∞"}`;
}

/** Read a number as people type it, or null; a comma counts as the decimal point. */
export function typed(text) {
  const clean = text.trim().replace(",", ".").replace("−", "-");
  const value = Number(clean);
  return clean !== "" && Number.isFinite(value) ? value : null;
}
