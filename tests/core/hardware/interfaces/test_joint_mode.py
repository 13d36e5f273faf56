"""Joint modes have the numbers and names of the original."""

import pytest

from station.core.errors import HardwareInterfaceError
from station.core.hardware.interfaces import (
    JointCommandMode,
    JointModeHandle,
    JointModeInterface,
)


def test_a_mode_is_read_and_set():
    modes = [JointCommandMode.BEGIN, JointCommandMode.BEGIN]
    handle = JointModeHandle("j", modes, 1)

    handle.set_mode(JointCommandMode.MODE_EFFORT)

    assert modes == [JointCommandMode.BEGIN, JointCommandMode.MODE_EFFORT]
    assert handle.get_mode() is JointCommandMode.MODE_EFFORT


@pytest.mark.parametrize(
    ("number", "name"),
    [
        (-1, "not_operational"),
        (0, "position"),
        (1, "velocity"),
        (2, "effort"),
        (3, "other"),
        (4, "emergency_stop"),
        (5, "switching"),
        (6, "error"),
    ],
)
def test_numbers_and_names(number, name):
    handle = JointModeHandle("j", [JointCommandMode.NOMODE])

    assert handle.get_mode_name(JointCommandMode(number)) == name


def test_missing_data_is_refused_as_in_the_original():
    with pytest.raises(HardwareInterfaceError) as caught:
        JointModeHandle("j", None)

    assert str(caught.value) == (
        "Cannot create mode interface. Mode data pointer is null."
    )


def test_asking_for_a_mode_claims_nothing():
    interface = JointModeInterface()
    interface.register_handle(JointModeHandle("j", [JointCommandMode.NOMODE]))

    interface.get_handle("j")

    assert interface.get_claims() == []
