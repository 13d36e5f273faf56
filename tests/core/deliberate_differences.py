"""Where the manager deliberately answers otherwise than the recorded original.

Each entry says what differs and why; `test_controller_manager_vectors.py` applies them
and compares everything else.
"""

UPDATES_DURING_LOAD = (
    "CM-32: load and unload do not wait for the control thread; they swap an immutable "
    "tuple. The cycles that the original ran while it waited are not there."
)

ESCAPED_EXCEPTIONS = (
    "CM-25: any exception of a loader is refused with its reason; in the original "
    "those that are no runtime_error escape from load_controller."
)

REFUSALS_RAISE = (
    "A refusal raises an error of station.core.errors with its reasons where the "
    "original returns False."
)

OPS_WITHOUT_UPDATES = frozenset({"load", "unload", "reload_libraries"})
"""Operations to which UPDATES_DURING_LOAD applies."""
