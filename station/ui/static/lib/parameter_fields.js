// Fields for the parameters of a controller: what its type declares, with unit and default.
import { breakable, drawn, h } from "./dom.js";
import { Refusal } from "./station.js";
import { typed } from "./text.js";

/** Return whether a declared name such as `<joint>/pid/p` stands for a path. */
function standsFor(name, path) {
  const parts = name.split("/");
  return parts.length === path.length && parts.every((part, i) => part === "<joint>" || part === path[i]);
}

function kindOf(declared, value) {
  if (declared) return declared.type;
  if (Array.isArray(value)) return value.every((each) => typeof each === "number") ? "numbers" : "strings";
  return typeof value;
}

function rangeOf({ minimum, maximum, excludes_minimum: open }) {
  if (minimum == null && maximum == null) return "";
  return `${open ? "above " : ""}${minimum ?? "−∞"} to ${maximum ?? "∞"}`;
}

function field(path, value, declared, names) {
  const kind = kindOf(declared, value);
  const text = Array.isArray(value) ? value.join(", ") : String(value ?? "");
  const byDefault = declared?.default == null ? (declared?.default_text ?? "") : [declared.default].flat().join(", ") || "none";
  const choices = kind === "boolean" ? ["true", "false"] : (declared?.choices ?? []);
  let input;
  if (choices.length && !kind.endsWith("s")) {
    input = h("select", {}, h("option", { value: "" }, byDefault ? `default: ${byDefault}` : "–"), ...choices.map((choice) => h("option", {}, choice)));
    input.value = text;
  } else {
    input = h("input", { value: text, placeholder: byDefault ? `default: ${byDefault}` : "" });
  }
  const label = path.join(" / ");
  input.setAttribute("aria-label", label);
  const shown = path.map((part) => names.get(part) ?? part).join("/");
  const facts = declared ? [shown === label ? "" : label, declared.description, rangeOf(declared), choices.join(", ")].filter(Boolean).join("; ") : "";
  const unit = [declared?.unit, declared?.required ? "required" : ""].filter(Boolean).join(", ");
  return { path, input, kind, row: h("label", { title: facts }, drawn(h("span"), breakable(shown, "_")), input, h("small", {}, unit)) };
}

function leaves(params, path = []) {
  return Object.entries(params).flatMap(([key, value]) =>
    value !== null && typeof value === "object" && !Array.isArray(value) ? leaves(value, [...path, key]) : [[[...path, key], value]],
  );
}

/**
 * Return fields for the parameters of an example and for every other one that is declared.
 * Parameters of each joint are offered where the example has them, and in YAML. `names` are
 * the short names of joints.
 */
export function fieldsOf(params, declared, names) {
  const found = leaves(params);
  const fields = found.map(([path, value]) => field(path, value, declared.find((each) => standsFor(each.name, path)), names));
  const others = declared.filter((each) => each.type !== "mappings" && !each.name.includes("<") && !found.some(([path]) => standsFor(each.name, path)));
  return [...fields, ...others.map((each) => field(each.name.split("/"), undefined, each, names))];
}

function valueOf({ path, input, kind }) {
  const text = input.value.trim();
  const numeric = (part) => {
    const value = typed(part);
    if (value === null) throw new Refusal(0, { code: "not_a_number", detail: `${path.join(" / ")}: “${part}” is not a number.` });
    return value;
  };
  const parts = text.split(",").map((part) => part.trim()).filter(Boolean);
  if (kind === "number") return numeric(text);
  if (kind === "boolean") return text === "true";
  if (kind === "numbers") return parts.map(numeric);
  if (kind === "strings") return parts;
  if (kind === "number_or_numbers") return parts.length > 1 ? parts.map(numeric) : numeric(text);
  return text;
}

/** Return the parameters; an empty field is left out, so that its default holds. */
export function valuesOf(fields) {
  const params = {};
  for (const each of fields) {
    if (each.input.value.trim() === "") continue;
    let place = params;
    for (const key of each.path.slice(0, -1)) place = place[key] ??= {};
    place[each.path.at(-1)] = valueOf(each);
  }
  return params;
}
