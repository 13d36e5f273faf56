"""Deliberate differences of the manager from ros_control's manager, with reasons.

`recorded_behaviour.py` applies the differences that affect a recorded run (refusals,
CM-32, CM-25, CM-67) to the recording, and compares everything else word by word.
"""

DIFFERENCES = {
    "refusals": (
        "A refusal raises an error of station.core.errors with its reasons where the "
        "original returns False."
    ),
    "CM-32": (
        "load and unload do not wait for the control thread; they swap an immutable "
        "tuple. The cycles that the original ran while it waited are not there."
    ),
    "CM-25": (
        "Any exception of a loader is refused with its reason; in the original those "
        "that are no runtime_error escape from load_controller."
    ),
    "CM-62": (
        "A switch in which a controller was aborted is still answered, but with "
        "ok=False and the reason per controller."
    ),
    "CM-61": (
        "A controller whose start raises, writes no finite number or jumps is taken "
        "off in the same cycle. A strict switch is then taken back: what was stopped "
        "is started again, and the switch is refused."
    ),
    "CM-66": (
        "Stops happen in the first cycle only; the original repeats them, and stops a "
        "controller again that best effort started in the same request."
    ),
    "CM-60": (
        "A do_switch that raises is taken back by the reverse do_switch, and what ran "
        "runs on; the original's do_switch cannot fail."
    ),
    "CM-67": (
        "What could not be started because of an ERROR or the timeout is taken off the "
        "hardware by one more do_switch; a strict switch is then taken back, and what "
        "was stopped runs again. The original leaves the hardware in the new mode and "
        "what it has stopped stopped. If the hardware cannot be taken back either, "
        "everything in the switch is stopped, and the result says so."
    ),
    "CM-74": (
        "A switch that no cycle has begun is withdrawn at its deadline, for hardware "
        "and controllers alike; without a timeout the deadline is 5 s of wall time. "
        "With bound=None there is no deadline, as in the original."
    ),
    "inverted limits": (
        "Limits whose minimum is above their maximum are refused when they are read; "
        "the original passes them on, and its saturation then gives the maximum."
    ),
    "unowned commands": (
        "A resource without an owner holds its rest command; in the original the last "
        "command of a stopped controller goes on acting if the robot lets it."
    ),
    "CM-32 in threads": (
        "Controllers are created and initialised in threads of their own and under no "
        "lock, shown in a state 'loading', and given up after a deadline."
    ),
    "CM-75": "A controller that was never initialised ends the switch as failed.",
    "CM-76": "Concurrent callers are served one after the other; no request is lost.",
    "CM-80": (
        "Exceptions and commands that are not finite stop their controller alone, in "
        "the same cycle, with rest commands; its fallback takes over."
    ),
    "CM-110": "init raises with the reason instead of returning False.",
    "CM-114": "switch_result of a combined robot asks its robots.",
}
"""Each difference with its reason, by the number of the behaviour."""

WITHOUT_UPDATES = frozenset({"load", "unload"})
"""Operations from whose recorded traces CM-32 removes every cycle."""
