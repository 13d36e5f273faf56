"""Describe the effect of a request in words, and as a mark in plots."""

import re

# Method and route, verb for a refusal, verb for a success, and object. `*` matches a
# part of the path, to which `{0}` and `{1}` refer. The first matching route counts.
_DEEDS = (
    ("POST /stop", "stop", "stopped", "the robot"),
    ("POST /stop/release", "release", "released", "the stop, or allowed motion"),
    ("POST /controllers", "load", "loaded", "a controller"),
    ("DELETE /controllers/*", "unload", "unloaded", "{0}"),
    ("POST /controllers/switch", "switch", "switched", "controllers"),
    ("PATCH /controllers/*/gains", "change", "changed", "gains of {0}"),
    ("PUT /controllers/*/command", "command", "commanded", "{0}"),
    ("POST /controllers/*/(?:goals|trajectory)", "send", "sent", "{0} a goal"),
    ("DELETE /controllers/*/goals/*", "cancel", "cancelled", "a goal of {0}"),
    ("PATCH /gains", "change", "changed", "gains"),
    ("POST /(?:controllers/*/)?bench.*", "test", "tested", "a joint"),
    ("POST /gain-sets/undo", "take back", "took back", "the last change of gains"),
    ("PUT /gain-sets/*", "save", "saved", "the gain set {0}"),
    ("POST /gain-sets/*/apply", "apply", "applied", "the gain set {0}"),
    ("DELETE /gain-sets/*", "delete", "deleted", "the gain set {0}"),
    ("PUT /waypoint-paths/*", "save", "saved", "the waypoint path {0}"),
    ("DELETE /waypoint-paths/*", "delete", "deleted", "the waypoint path {0}"),
    ("POST /waypoint-paths/*/capture", "capture", "captured", "a waypoint of {0}"),
    ("POST /waypoint-paths/*/play", "play", "played", "the waypoint path {0}"),
    ("PATCH /playback", "change", "changed", "how a waypoint path plays"),
    ("DELETE /playback", "end", "ended", "a waypoint path"),
    ("PATCH /simulation", "change", "changed", "the pace of the simulation"),
    ("POST /simulation/step", "step", "stepped", "the simulation"),
    ("POST /simulation/reset", "reset", "reset", "the simulation"),
    ("POST /robots/(?:*/)?error_recovery", "recover", "recovered", "the robot"),
    ("POST /robots/*/guiding", "switch", "switched", "the guiding of {0}"),
    ("POST /robots/*/user_stop", "switch", "switched", "the user stop of {0}"),
    ("POST /robots/*/external_force", "push", "pushed", "{0}"),
    ("POST /robots/*/faults", "inject", "injected", "a fault into {0}"),
    ("DELETE /robots/*/faults", "end", "ended", "the faults of {0}"),
    ("PUT /robots/*/*", "set", "set", "{1} of {0}"),
    ("POST /robots/*/gripper/*", "command", "commanded", "the gripper of {0} to {1}"),
    ("PUT /plot-layouts/*", "save", "saved", "the layout {0}"),
    ("DELETE /plot-layouts/*", "delete", "deleted", "the layout {0}"),
    ("PUT /scene/*", "change", "changed", "the object {0}"),
    ("DELETE /scene/*", "remove", "removed", "the object {0}"),
    ("POST /rehearse", "rehearse", "rehearsed", "a motion"),
    ("POST /plan", "plan", "planned", "a motion"),
    ("POST /recordings/upload", "upload", "uploaded", "a recording"),
    ("POST /recordings", "begin", "began", "a recording"),
    ("POST /recordings/*/stop", "end", "ended", "the recording {0}"),
    ("POST /alarms/*/acknowledge", "acknowledge", "acknowledged", "an alarm"),
    ("POST /experiments", "begin", "began", "an experiment"),
    ("POST /experiments/*/cancel", "cancel", "cancelled", "the experiment {0}"),
    ("POST /experiments/*/apply", "apply", "applied", "the gains of experiment {0}"),
    ("(?:POST|PUT) /control(?:/.*)?", "take", "took", "control"),
    ("PATCH /control(?:/.*)?", "offer", "offered", "control"),
    ("DELETE /control(?:/.*)?", "give back", "gave back", "control"),
)
_MARKS = (
    ("PATCH /gains", "gains"),
    ("POST /gain-sets/undo", "gains undone"),
    ("POST /gain-sets/*/apply", "gain set {0}"),
    ("POST /experiments/*/apply", "gains of {0}"),
    ("POST /simulation/reset", "reset"),
    ("POST /robots/(?:*/)?error_recovery", "recovery"),
)
_PART = re.compile(r"(?<!\.)\*")


def _pattern(route: str) -> re.Pattern[str]:
    return re.compile(_PART.sub("([^/]+)", route))


_WORDS = [(_pattern(route), verb, past, thing) for route, verb, past, thing in _DEEDS]
_MARKED = [(_pattern(route), mark) for route, mark in _MARKS]


def words_of(what: str, who: str, result: str, *, is_done: bool) -> str:
    """Return a sentence about a request.

    Args:
        what: Method and route of the request.
        who: Person or program that sent the request.
        result: Status and code of the answer.
        is_done: Whether it was carried out.
    """
    for route, verb, past, thing in _WORDS:
        found = route.fullmatch(what)
        if found:
            named = thing.format(*found.groups())
            done, refused = f"{past} {named}", f"could not {verb} {named} ({result})"
            return f"{who} {done if is_done else refused}."
    ended = "was carried out" if is_done else f"was refused: {result}"
    return f"{what} of {who} {ended}."


def mark_of(what: str) -> str | None:
    """Return the mark in plots for a request that was carried out; None without one.

    Args:
        what: Method and route of the request.
    """
    for route, mark in _MARKED:
        found = route.fullmatch(what)
        if found:
            return mark.format(*found.groups())
    return None
