"""Step MuJoCo without a chance for other threads to take the interpreter.

MuJoCo's Python binding releases the interpreter lock in `mj_step`. A busy thread then
takes the lock, and the control loop waits for it longer than the step lasts. The same C
function keeps the lock if it is called through `ctypes.PyDLL`.
"""

import ctypes
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import mujoco

_MAX_STEPS_COMPARED = 2


class Stepper(NamedTuple):
    """The implementation of a simulation step.

    Attributes:
        step: Makes one step.
        addresses: Addresses of the C function that makes the same step and keeps the
            lock, and of its model and data; zeros without such a function.
    """

    step: Callable[[], None]
    addresses: tuple[int, int, int] = (0, 0, 0)

    @property
    def keeps_interpreter_lock(self) -> bool:
        """Return whether other threads are kept waiting during a step."""
        return self.addresses[0] != 0


def make_stepper(model: mujoco.MjModel, data: mujoco.MjData) -> Stepper:
    """Return a function that advances `data` by a step.

    The direct call is used only if a test shows that its results equal those of the
    binding bit for bit; otherwise the binding is used.

    Args:
        model: The model.
        data: Data of the model. Both must outlive the returned function.
    """
    binding = partial(mujoco.mj_step, model, data)
    function = _find_function("mj_step")
    addresses = _addresses(model, data)
    if function is None or addresses is None or not _agrees(function, model):
        return Stepper(binding)
    places = ctypes.cast(function, ctypes.c_void_p), *addresses
    numbers = [place.value or 0 for place in places]
    return Stepper(partial(function, *addresses), (numbers[0], numbers[1], numbers[2]))


def direct_function(
    name: str, model: mujoco.MjModel, data: mujoco.MjData
) -> Callable[[], None]:
    """Return a MuJoCo function of model and data that keeps the interpreter lock.

    If the library cannot be called directly, the function of the binding is returned.

    Args:
        name: Name of the function in C, e.g. `mj_fwdPosition`.
        model: The model.
        data: Data of the model. Both must outlive the function.
    """
    function = _find_function(name)
    addresses = _addresses(model, data)
    if function is None or addresses is None:
        return partial(getattr(mujoco, name), model, data)
    return partial(function, *addresses)


def _find_function(name: str) -> Any:  # noqa: ANN401 - a function of ctypes, or None
    directory = Path(mujoco.__file__).parent
    for path in sorted(directory.glob("libmujoco*")):
        try:
            library = ctypes.PyDLL(str(path))
            library.mj_version.restype = ctypes.c_int
            if library.mj_version() != mujoco.mj_version():
                continue
            function: Any = getattr(library, name)
        except (OSError, AttributeError):
            # The library is missing, or has no function of that name.
            continue
        function.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
        function.restype = None
        return function
    return None


def _addresses(
    model: mujoco.MjModel, data: mujoco.MjData
) -> tuple[ctypes.c_void_p, ctypes.c_void_p] | None:
    addresses = (getattr(model, "_address", None), getattr(data, "_address", None))
    if not all(isinstance(address, int) for address in addresses):
        return None
    return ctypes.c_void_p(addresses[0]), ctypes.c_void_p(addresses[1])


def _agrees(function: Callable[..., None], model: mujoco.MjModel) -> bool:
    direct, reference = mujoco.MjData(model), mujoco.MjData(model)
    addresses = _addresses(model, direct)
    if addresses is None:
        return False
    for _ in range(_MAX_STEPS_COMPARED):
        function(*addresses)
        mujoco.mj_step(model, reference)
    return _state(direct) == _state(reference)


def _state(data: mujoco.MjData) -> tuple[float, list[float], list[float]]:
    return float(data.time), data.qpos.tolist(), data.qvel.tolist()
