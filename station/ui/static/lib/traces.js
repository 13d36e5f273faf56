// How traces look in all plots.

export const COLOURS = 7; // `--trace0` to `--trace6` in the style sheet
export const FONT = "11px system-ui, 'DejaVu Sans', sans-serif";
const DASHES = [[], [6, 3], [2, 3], [8, 3, 2, 3]];

/** Return the dashes of a trace: no two of 28 traces have the same colour and dashes. */
export function dashOf(i) {
  return DASHES[((i % COLOURS) + Math.floor(i / COLOURS)) % DASHES.length];
}

/** Return the ends of an axis for values from `low` to `high`. */
export function withRoom(low, high) {
  const room = Math.max((high - low) * 0.08, Math.max(Math.abs(high), 1) * 1e-3);
  return [low - room, high + room];
}

/** Return a piece of a trace for the legend, dashed as in the plot. */
export function swatch(i) {
  const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
  for (const [name, value] of Object.entries({ x1: 0, y1: 4, x2: 12, y2: 4, "stroke-dasharray": dashOf(i).join(" ") })) line.setAttribute(name, value);
  const picture = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  picture.setAttribute("aria-hidden", "true");
  picture.append(line);
  return picture;
}
