// What of the station's events is marked in the plots: switches, faults, gains, stops.

const NAME = "([^/]+)";
const REQUESTS = [
  [new RegExp(`^PATCH /controllers/${NAME}/gains$`), "gains of $1"],
  [/^PATCH \/gains$/, "gains"],
  [/^POST \/gain-sets\/undo$/, "gains undone"],
  [new RegExp(`^POST /gain-sets/${NAME}/apply$`), "gain set $1"],
  [new RegExp(`^POST /experiments/${NAME}/apply$`), "gains of $1"],
  [/^POST \/simulation\/reset$/, "reset"],
  [/^POST \/robots\/(.+\/)?error_recovery$/, "recovery"],
];
const OF_GAINS = /^(PATCH .*gains|POST \/(gain-sets|experiments)\/.*(undo|apply))$/;

const isDone = ({ kind, result }) => kind === "request" && /^2\d\d$/.test(result);

/** Return whether an event says that somebody has changed gains. */
export function changesGains(event) {
  return isDone(event) && OF_GAINS.test(event.what);
}

/** Return what an event is marked as in the plots: no text, or several. */
export function marksOf(event) {
  const { kind, what, result, details } = event;
  if (kind === "switch") return [...(details.stopped ?? []).map((name) => `${name} stopped`), ...(details.started ?? []).map((name) => `${name} started`)];
  if (kind === "fault") return [`${what} stopped by a fault`];
  if (kind === "stop") return result === "stopped" ? ["stop"] : [];
  if (kind === "robot_mode") return event.severity === "error" ? [`robot: ${result}`] : [];
  const found = isDone(event) && REQUESTS.find(([pattern]) => pattern.test(what));
  return found ? [what.replace(found[0], found[1])] : [];
}
