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
