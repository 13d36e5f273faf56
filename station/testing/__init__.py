"""Tests that authors run against their own robots, controllers and arms.

```python
from station.testing import RobotConformance

class TestMyRobot(RobotConformance):
    robot = MyRobotHW
    parameters = {"joints": ["shoulder", "elbow"]}
```

This package is for tests only: nothing else of the station imports it. The suites need
pytest, which is imported with the first suite; they need no plug-in.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from station.testing.bench import Bench as Bench
from station.testing.scripted import (
    HookScript as HookScript,
    ScriptedBench as ScriptedBench,
)
from station.testing.storm import StormReport as StormReport, storm as storm
from station.testing.switch_observer import SwitchObserver as SwitchObserver

if TYPE_CHECKING:
    from station.testing.conformance.arm_conformance import (
        ArmConformance as ArmConformance,
    )
    from station.testing.conformance.controller_conformance import (
        ControllerConformance as ControllerConformance,
    )
    from station.testing.conformance.robot_conformance import (
        RobotConformance as RobotConformance,
    )
    from station.testing.recorded.recorded_behaviour import (
        RecordedBehaviour as RecordedBehaviour,
    )
_SUITES = {
    "ArmConformance": "station.testing.conformance.arm_conformance",
    "ControllerConformance": "station.testing.conformance.controller_conformance",
    "RecordedBehaviour": "station.testing.recorded.recorded_behaviour",
    "RobotConformance": "station.testing.conformance.robot_conformance",
}


def __getattr__(name: str) -> object:
    """Return a suite of tests.

    Raises:
        AttributeError: There is no such name.
        ModuleNotFoundError: pytest is not installed.
    """
    module = _SUITES.get(name)
    if module is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if find_spec("pytest") is None:
        raise ModuleNotFoundError(
            f"{name} is a suite of tests for pytest, which is not installed. "
            "Install it with `pip install pytest`."
        )
    # With rewritten assertions a failing `assert` of the suite shows its values.
    import_module("pytest").register_assert_rewrite(module)
    return getattr(import_module(module), name)
