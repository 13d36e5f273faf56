"""An arm or a hand that forgets an operation cannot be constructed."""

import pytest

from station.core.franka import ArmSimulation, FrankaServices, GripperServices


@pytest.mark.parametrize(
    ("base", "forgotten"),
    [
        (FrankaServices, "set_load"),
        (FrankaServices, "set_EE_frame"),
        (FrankaServices, "simulation"),
        (GripperServices, "grasp"),
        (GripperServices, "stop"),
        (ArmSimulation, "clear_faults"),
    ],
)
def test_class_that_forgets_an_operation_cannot_be_constructed(base, forgotten):
    names = base.__abstractmethods__ - {forgotten}
    operations = {name: lambda *_: None for name in names}

    with pytest.raises(TypeError, match=forgotten):
        type("Incomplete", (base,), operations)()
