"""FrankaHW with a real arm's driver: what the loop and the controllers see of it."""

import pytest

from station.core.errors import (
    GripperLostError,
    HardwareInterfaceError,
    ParameterError,
    SwitchRefusedError,
)
from station.core.franka import GripperServicesInterface
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointStateInterface,
    PositionJointInterface,
)
from station.core.hardware.robot_hw import SwitchState
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.fci.driver import connection
from station.hw.franka.fci.driver.fci_arm import FciArm
from station.hw.franka.fci.driver.fci_client import IncompatibleVersionError
from station.hw.franka.fci.driver.network import FciNetworkError
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.robot_protocol import PROTOCOLS, Command, Status
from station.hw.franka.franka_combined_hw import FrankaCombinedHW
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.simulated.arm_model import ArmModel
from tests.hw.franka.fci.driver.test_driver import answering
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.hw.franka.scripted_arm import ScriptedArm
from tests.hw.franka.test_franka_hw import (
    PERIOD,
    ROBOT,
    controllers,
    drive,
    run,
    switch,
)

ADDRESS = "172.16.0.2"


@pytest.fixture
def network(monkeypatch):
    """Put a scripted arm at every address, and no hand."""
    joined = SteppedNetwork(ScriptedArm())

    def open_network(host, port):
        if port == HAND.port:
            raise FciNetworkError(f"libfranka: Connection to FCI refused at {host}.")
        return joined

    monkeypatch.setattr(connection, "FciNetwork", open_network)
    return joined


@pytest.fixture
def make():
    """Make robots, and close them at the end."""
    made = []

    def make_robot(**parameters):
        told = {"robot_ip": ADDRESS, "realtime_config": "ignore", **parameters}
        tree = ParameterTree({"robot": {**ROBOT, **told}})
        made.append(FrankaHW())
        made[-1].init(Parameters(tree), Parameters(tree, "robot"))
        return made[-1]

    yield make_robot
    for hw in made:
        hw.close()


def test_robot_ip_selects_the_driver_with_nothing_of_a_simulation(network, make):
    hw = make(collision_config={"lower_torque_thresholds_nominal": [11.0] * 7})
    assert isinstance(hw.arm, FciArm)
    assert hw.simulated_world() is None
    assert hw.arm.simulation() is None
    assert hw.robot_clock() is hw.arm
    behavior = network.arm.behavior
    assert behavior.lower_torque_thresholds_nominal == (11.0,) * 7
    hw.close()
    assert network.is_closed


@pytest.fixture
def asked(monkeypatch):
    """Put an arm that speaks one version at every address; note the connections."""

    def serve(version):
        opened = []

        def open_network(host, port):
            if port == HAND.port:
                raise FciNetworkError(f"libfranka: There is no hand at {host}.")
            opened.append(SteppedNetwork(ScriptedArm(), PROTOCOLS[version]))
            return opened[-1]

        monkeypatch.setattr(connection, "FciNetwork", open_network)
        return opened

    return serve


@pytest.mark.parametrize("version", [6, 7, 8, 9, 10])
def test_fr3_is_spoken_to_in_the_version_of_its_system(asked, make, version):
    opened = asked(version)
    hw = make(arm="fr3")
    # The first one asked for the newest version.
    refused = [True] if version < 10 else []
    assert [network.is_closed for network in opened] == [*refused, False]
    switch(hw, "jt")
    drive(hw, EffortJointInterface, [0.5] * 7, 2)
    assert hw.mode() == "move"
    state = PROTOCOLS[version].state.unpack(opened[-1].session.state(99))
    assert state["motion_generator_mode"] == (5 if version > 6 else 2)


@pytest.mark.parametrize(("arm", "version"), [("panda", 10), ("fr3", 5)])
def test_arm_of_another_kind_is_refused(asked, make, arm, version):
    asked(version)
    with pytest.raises(IncompatibleVersionError) as refused:
        make(arm=arm)
    assert f"server version: {version}" in refused.value.message
    assert "robot.arm" in refused.value.remedy


@pytest.mark.usefixtures("network")
def test_model_is_the_stations_own(make):
    assert isinstance(make().arm.load_model(), ArmModel)


def test_arm_that_does_not_answer_is_told(monkeypatch):
    def refuse(host, port):
        raise FciNetworkError(f"libfranka: Connection timeout at {host}:{port}.")

    monkeypatch.setattr(connection, "FciNetwork", refuse)
    tree = ParameterTree({"robot": {**ROBOT, "robot_ip": ADDRESS}})
    with pytest.raises(FciNetworkError, match=r"timeout at 172\.16\.0\.2:1337"):
        FrankaHW().init(Parameters(tree), Parameters(tree, "robot"))


@pytest.mark.usefixtures("network")
def test_loop_at_another_rate_than_the_arm_is_refused(make):
    hw = make()
    hw.check_period(PERIOD)
    with pytest.raises(HardwareInterfaceError, match="real arm 'panda' needs") as error:
        hw.check_period(0.002)
    assert "1000" in error.value.remedy


@pytest.mark.usefixtures("network")
def test_switch_without_a_realtime_thread_is_refused(monkeypatch, make):
    hw = make(realtime_config="enforce")
    monkeypatch.setattr(hw.arm, "_find_problem", lambda _thread: "no SCHED_FIFO")
    with pytest.raises(SwitchRefusedError, match="no SCHED_FIFO"):
        hw.prepare_switch(controllers("jp"), [])


def test_motion_that_the_arm_refuses_fails_the_switch_and_not_the_loop(
    network, monkeypatch, make
):
    hw = make()
    answering(
        monkeypatch, network, Command.MOVE, Status.START_AT_SINGULAR_POSE_REJECTED
    )
    switch(hw, "jp")
    assert hw.switch_result() is SwitchState.ERROR
    run(hw, 3)
    assert hw.mode() == "idle"


@pytest.mark.usefixtures("network")
def test_lost_arm_stops_the_controllers_with_its_reason(make):
    hw = make()
    switch(hw, "jp")
    drive(hw, PositionJointInterface, list(hw.robot_state.q_d), 5)
    hw.arm._link._lose(FciNetworkError("libfranka: UDP receive: Timeout"))
    run(hw, 1)
    assert hw.is_interrupted()
    reason = hw.interruption_of(controllers("jp")[0])
    assert reason == "arm 'panda' went to other (libfranka: UDP receive: Timeout)"


@pytest.mark.usefixtures("network")
def test_hand_of_the_urdf_that_does_not_answer_is_told(make):
    hw = make()
    hand = hw.get(GripperServicesInterface).get_handle("panda")
    with pytest.raises(GripperLostError, match="Connection to FCI refused at 172"):
        hand.homing()


@pytest.mark.usefixtures("network")
@pytest.mark.parametrize("is_told", [False, True])
def test_fingers_of_a_real_hand_are_in_the_joint_states_if_told(make, is_told):
    states = make(fingers_in_joint_states=is_told).get(JointStateInterface)
    assert ("panda_finger_joint1" in states.get_names()) is is_told


def test_combined_arms_are_simulated_alone():
    tree = ParameterTree({
        "robot": {"robot_hardware": ["left"], "left": {**ROBOT, "robot_ip": ADDRESS}}
    })
    with pytest.raises(ParameterError, match="robot_ip 172") as error:
        FrankaCombinedHW().init(Parameters(tree), Parameters(tree, "robot"))
    assert "a station of its own for each real arm" in error.value.remedy
