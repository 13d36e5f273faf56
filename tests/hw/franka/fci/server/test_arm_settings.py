"""What a client may set, what is refused, and when."""

from math import nan

import pytest

from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.fci.wire.robot_protocol import Command, Status

GOOD = {
    Command.SET_COLLISION_BEHAVIOR: {
        f"{bound}_{kind}_thresholds_{phase}": [20.0] * (7 if kind == "torque" else 6)
        for bound in ("lower", "upper")
        for kind in ("torque", "force")
        for phase in ("acceleration", "nominal")
    },
    Command.SET_JOINT_IMPEDANCE: {"K_theta": [1000.0] * 7},
    Command.SET_CARTESIAN_IMPEDANCE: {"K_x": [100.0] * 6},
    Command.SET_GUIDING_MODE: {"guiding_mode": [True] * 6, "nullspace": False},
    Command.SET_EE_TO_K: {"EE_T_K": [*IDENTITY]},
    Command.SET_NE_TO_EE: {"NE_T_EE": [*IDENTITY]},
    Command.SET_LOAD: {"m_load": 0.5, "I_load": (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01)},
    Command.SET_FILTERS: {
        f"{name}_filter_frequency": 1000.0
        for name in (
            "joint_position",
            "joint_velocity",
            "cartesian_position",
            "cartesian_velocity",
            "controller",
        )
    },
}
BAD = {
    Command.SET_COLLISION_BEHAVIOR: {},
    Command.SET_JOINT_IMPEDANCE: {"K_theta": [nan] * 7},
    Command.SET_CARTESIAN_IMPEDANCE: {"K_x": [1e6] * 6},
    Command.SET_GUIDING_MODE: {"guiding_mode": [True] * 5 + [False]},
    Command.SET_EE_TO_K: {},
    Command.SET_NE_TO_EE: {"NE_T_EE": [nan] * 16},
    Command.SET_LOAD: {"m_load": -1.0},
    Command.SET_FILTERS: {},
}


@pytest.mark.parametrize("command", GOOD)
def test_setter_succeeds_refuses_bad_values_and_waits_for_the_end_of_a_motion(
    client, command
):
    assert client.ask(command, **GOOD[command]) == [Status.SUCCESS]
    bad = client.ask(command, **BAD[command])
    assert bad == [Status.INVALID_ARGUMENT_REJECTED]
    client.move()
    client.cycle()
    during = client.ask(command, **GOOD[command])
    assert during == [Status.COMMAND_NOT_POSSIBLE_REJECTED]
