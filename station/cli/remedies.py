"""Remedies of the API for a terminal: verbs in place of routes."""

import re
from collections.abc import Mapping

_ROUTE = r"(?:GET|POST|PUT|PATCH|DELETE) /"
_ASIDE = re.compile(rf"\s*\({_ROUTE}[^)]*\)|:\s*{_ROUTE}\S*(?=\.$)")
_SENTENCES = re.compile(r"(?<=[.!?])\s+(?=[A-Z])")

VERBS: Mapping[str, str] = {
    "agent_request_not_found": "`station agents list` lists them.",
    "bench_run_not_found": "`station bench list` lists the runs.",
    "certificate_not_found": "`station rehearse --certificate` gives a new one.",
    "certificate_void": "`station rehearse --certificate` gives a new one.",
    "control_held": "`station control show` says who holds control.",
    "control_not_held": "`station control take` takes it.",
    "controller_not_found": "`station list_controllers` lists the loaded ones.",
    "controller_state": "`station switch_controllers` starts and stops controllers.",
    "controller_type_not_found": "`station list_controller_types` lists the types.",
    "experiment_not_found": "`station experiments list` lists the experiments.",
    "experiment_running": "`station experiments cancel` ends one.",
    "gain_set_not_found": "`station gains list` lists the gain sets.",
    "gains_changed": "`station gains show` has the present ones.",
    "invalid_gain": "`station gains show` has names and ranges.",
    "lesson_not_found": "`station lesson list` lists the lessons.",
    "no_sample": "Start the controller: `station start`.",
    "parameter_not_found": "`station parameters get` has the whole tree.",
    "recording_not_found": "`station record list` and `station incidents` list them.",
    "rehearsal_needed": "`station rehearse --certificate` gives one.",
    "resource_conflict": "`station switch_controllers` stops and starts at once.",
    "saved_scene_not_found": "`station scene saved` lists the scenes.",
    "service_not_found": "`station robot` with an arm's name lists the services.",
    "simulation_refused": "`station pause` and `station resume` change that.",
    "stopped": "`station release` releases the stop, and `station release --arm` "
    "allows motion.",
    "token_not_found": "`station token list` lists the named tokens.",
}
"""The verb that helps with an error, by the code of the error."""


def for_terminal(code: str, remedy: str) -> str:
    """Return a remedy of the API as a person at a terminal can follow it.

    Args:
        code: Code of the error.
        remedy: The remedy. A sentence about a route is replaced by the verb for the
            code, or left out where no verb does it.
    """
    sentences = [_ASIDE.sub("", each) for each in _SENTENCES.split(remedy)]
    kept = [each for each in sentences if not re.search(_ROUTE, each)]
    if re.search(_ROUTE, remedy) and code in VERBS:
        kept.append(VERBS[code])
    return " ".join(kept)
