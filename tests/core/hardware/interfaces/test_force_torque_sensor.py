"""Force-torque sensors."""

import pytest

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces import (
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
)


def test_values_are_copies_of_the_robots_own():
    force, torque = [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]
    handle = ForceTorqueSensorHandle("wrist", "tool0", force, torque)
    force[0] = 9.0

    handle.get_torque()[0] = 99.0

    assert handle.get_frame_id() == "tool0"
    assert handle.get_force() == [9.0, 2.0, 3.0]
    assert handle.get_torque() == [4.0, 5.0, 6.0]


@pytest.mark.parametrize(("force", "torque"), [(None, [0.0] * 3), ([0.0] * 3, [0.0])])
def test_missing_data_is_refused(force, torque):
    with pytest.raises(HardwareInterfaceError, match="'wrist'"):
        ForceTorqueSensorHandle("wrist", "tool0", force, torque)


def test_reading_claims_nothing():
    interface = ForceTorqueSensorInterface()
    interface.register_handle(
        ForceTorqueSensorHandle("wrist", "tool0", [0.0] * 3, [0.0] * 3)
    )

    interface.get_handle("wrist")

    assert interface.get_claims() == []
