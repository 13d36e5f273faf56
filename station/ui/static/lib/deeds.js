// What somebody has done, in words: the station's events of requests name routes.

// Method and route, and the verbs for a refusal and for a deed, a line for each subject.
const DEEDS = `
POST /stop: stop/stopped the robot; POST /stop/release: release/released the stop, or allow/allowed motion
POST /controllers: load/loaded a controller; DELETE /controllers/*: unload/unloaded $1; POST /controllers/switch: switch/switched controllers
PATCH /controllers/*/gains: change/changed gains of $1; PUT /controllers/*/command: command/commanded $1
POST /controllers/*/(?:goals|trajectory): send/sent $1 a goal; DELETE /controllers/*/goals/*: cancel/cancelled a goal of $1
PATCH /gains: change/changed gains; POST /(?:controllers/*/)?bench.*: test/tested a joint; POST /gain-sets/undo: take back/took back the last change of gains
PUT /gain-sets/*: save/saved the gain set $1; POST /gain-sets/*/apply: apply/applied the gain set $1; DELETE /gain-sets/*: delete/deleted the gain set $1
PUT /waypoint-paths/*: save/saved the waypoint path $1; DELETE /waypoint-paths/*: delete/deleted the waypoint path $1
POST /waypoint-paths/*/capture: capture/captured a waypoint of $1; POST /waypoint-paths/*/play: play/played the waypoint path $1
PATCH /playback: change/changed how a waypoint path plays; DELETE /playback: end/ended a waypoint path
PATCH /simulation: change/changed the pace of the simulation; POST /simulation/step: step/stepped the simulation; POST /simulation/reset: reset/reset the simulation
POST /robots/(?:*/)?error_recovery: recover/recovered the robot; POST /robots/*/guiding: switch/switched the guiding of $1
POST /robots/*/user_stop: switch/switched the user stop of $1; POST /robots/*/external_force: push/pushed $1
POST /robots/*/faults: inject/injected a fault into $1; DELETE /robots/*/faults: end/ended the faults of $1
PUT /robots/*/*: set/set $2 of $1; POST /robots/*/gripper/*: command/commanded the gripper of $1 to $2
PUT /plot-layouts/*: save/saved the layout $1; DELETE /plot-layouts/*: delete/deleted the layout $1; PUT /scene/*: change/changed the object $1; DELETE /scene/*: remove/removed the object $1; POST /rehearse: rehearse/rehearsed a motion; POST /plan: plan/planned a motion
POST /recordings/upload: upload/uploaded a recording; POST /recordings: begin/began a recording; POST /recordings/*/stop: end/ended the recording $1; POST /alarms/*/acknowledge: acknowledge/acknowledged an alarm
POST /experiments: begin/began an experiment; POST /experiments/*/cancel: cancel/cancelled the experiment $1; POST /experiments/*/apply: apply/applied the gains of the experiment $1
(?:POST|PUT) /control(?:/.*)?: take/took control; PATCH /control(?:/.*)?: offer/offered control; DELETE /control(?:/.*)?: give back/gave back control`
  .trim()
  .split(/; |\n/)
  .map((line) => line.split(": "))
  .map(([route, words]) => [new RegExp(`^${route.replace(/(?<!\.)\*/g, "([^/]+)")}$`), words]);
const VERBS = /\b(take back|give back|[a-z]+)\/(took back|gave back|[a-z]+)\b/g;
const AGAIN = /^\d+ more times within [\d.]+ s: /;

/** Return the words for an event of the station, without the person: a request says what was done, or what was not. */
export function deedOf({ kind, what, result, text }) {
  const found = kind === "request" && DEEDS.find(([route]) => route.test(what));
  if (!found) return text || `${kind} ${what} ${result}`;
  const isDone = /^[23]\d\d/.test(result);
  const words = what.replace(found[0], found[1].replace(VERBS, isDone ? "$2" : "$1"));
  const again = AGAIN.exec(text)?.[0] ?? "";
  return `${again}${isDone ? words : `could not ${words} (${result})`}.`;
}
