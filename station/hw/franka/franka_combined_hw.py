"""Several Franka arms in one world, driven by torques; an error stops all of them.

Source: franka_ros@c11f000 franka_hw/src/franka_combinable_hw.cpp,
franka_combined_hw.cpp; differs: all arms are read and commanded in one cycle; a
controller that claims only some joints of an arm is refused; after an error of one arm
the controllers of all arms are stopped and wait for a recovery, instead of running on.
"""

from collections.abc import Sequence
from itertools import permutations

from typing_extensions import override

from station.core.description.robot_description import ROBOT_DESCRIPTION
from station.core.errors import ParameterError, SwitchRefusedError
from station.core.franka.franka_robot_state import RobotMode
from station.core.geometry.scene import read_scene
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.hardware.interfaces import JointCommandInterface, JointStateInterface
from station.core.hardware.robot_hw import ControllerInfo, ResourceConflict
from station.core.parameters import Parameters
from station.hw.franka.arm.control_mode import (
    MODE_OF_INTERFACE,
    ControlMode,
    arm_id_of,
    claims_of,
)
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import read_parameters
from station.hw.franka.simulated.franka_world import (
    FrankaWorld,
    combine_descriptions,
    placement_of,
    simulate,
)
from station.hw.robot_loader import create_robot

_EFFORT = "hardware_interface::EffortJointInterface"
_ERRONEOUS = (RobotMode.REFLEX, RobotMode.USER_STOPPED, RobotMode.OTHER)


class FrankaCombinableHW(FrankaHW):
    """Type `franka_hw/FrankaCombinableHW`: an arm that takes only torques.

    Interfaces: JointState, EffortJoint, FrankaState, FrankaModel, FrankaServices.
    """

    @override
    def command_interfaces(
        self,
    ) -> list[JointStateInterface | JointCommandInterface]:
        return [
            interface
            for interface in self.commands.interfaces()
            if isinstance(interface, JointStateInterface)
            or interface.type_name == _EFFORT
        ]

    @override
    def check_for_conflict(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        arm_id = self.parameters.arm_id
        motions = [
            ResourceConflict(
                claim.resource,
                ((claim.controller, claim.interface),),
                f"Arm '{arm_id}' is combined with others and takes torques alone, not "
                f"{claim.interface} of '{claim.controller}'.",
            )
            for claim in claims_of(controllers)
            if arm_id_of(claim.resource) == arm_id
            and MODE_OF_INTERFACE.get(claim.interface)
            not in {None, ControlMode.JOINT_TORQUE}
        ]
        return motions or super().check_for_conflict(controllers)


class FrankaCombinedHW(CombinedRobotHW):
    """Type `franka_hw/FrankaCombinedHW`.

    Parameters: `robot_hardware`, a list of names; and for each name a namespace with
    the parameters of FrankaHW and its own `base_xyz`.
    """

    def __init__(self) -> None:
        super().__init__(create_robot)
        self.arms: list[FrankaCombinableHW] = []

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Put all arms into one world.

        Raises:
            ParameterError: A parameter is missing or impossible, or two arms have the
                same `arm_id`.
            RobotDescriptionError: A URDF cannot be used.
        """
        names = hw_params.get_str_list("robot_hardware")
        parameters = [read_parameters(hw_params.namespace(name)) for name in names]
        arm_ids = [one.arm_id for one in parameters]
        # Resources are named after the arm, so two arms of the same name would share
        # them.
        if not names or len(set(arm_ids)) != len(arm_ids):
            raise ParameterError(
                f"The arms of '{hw_params.resolve('robot_hardware')}' are {arm_ids}; "
                "there must be at least one, each with an arm_id of its own.",
                remedy="Correct robot_hardware and the arm_id of each.",
            )
        gravities = {one.gravity for one in parameters}
        # One MuJoCo world has one gravity.
        if len(gravities) > 1:
            raise ParameterError(
                f"The arms of '{hw_params.resolve('robot_hardware')}' are in one world "
                f"and have {len(gravities)} vectors of gravity: {sorted(gravities)}.",
                remedy="Give all arms the same gravity.",
            )
        for name, one in zip(names, parameters, strict=True):
            if one.robot_ip is not None:
                raise ParameterError(
                    f"The arm '{name}' has robot_ip {one.robot_ip}; the arms of "
                    "FrankaCombinedHW are simulated.",
                    remedy="Run a station of its own for each real arm, with "
                    "franka_hw/FrankaHW and other ports (api.port, ui.port), or leave "
                    "robot_ip out to simulate the arms.",
                )
        placements = [placement_of(one) for one in parameters]
        if not root_params.has(ROBOT_DESCRIPTION):
            root_params.set(ROBOT_DESCRIPTION, combine_descriptions(placements))
        self._world = simulate(
            placements,
            gravity=parameters[0].gravity,
            objects=read_scene(root_params),
        )
        for name, one in zip(names, parameters, strict=True):
            arm = self._world.arms[one.arm_id]
            arm.set_collision_behavior(one.collision_behavior)
            robot = FrankaCombinableHW()
            robot.enter_world(self._world, one.arm_id)
            robot.init(root_params, hw_params.namespace(name))
            self.arms.append(robot)
            self.add_robot(name, robot)
        guards = [one for robot in self.arms for one in robot.guards()]
        for guard, other in permutations(guards, 2):
            guard.add_neighbour(other)

    def erroneous_arm(self) -> FrankaCombinableHW | None:
        """Return the first arm that cannot move; None if all arms can."""
        for robot in self.arms:
            if robot.robot_state.robot_mode in _ERRONEOUS:
                return robot
        return None

    @override
    def check_for_conflict(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        found: list[ResourceConflict] = []
        for robot in self.arms:
            found += [
                one for one in robot.check_for_conflict(controllers) if one not in found
            ]
        return found

    @override
    def simulated_world(self) -> FrankaWorld:
        """Return the one world of all arms."""
        return self._world

    @override
    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Refuse to start controllers that command an arm while one has an error.

        Raises:
            SwitchRefusedError: An arm has an error, or refuses the switch.
        """
        robot = self.erroneous_arm()
        # An error of one arm stops all arms: arms that work together must not continue
        # alone.
        if robot is not None and claims_of(start):
            raise SwitchRefusedError(
                f"Not all arms can move: {_why_stopped(robot)}; {robot.arm.remedy()}.",
                remedy="Recover all arms first.",
                details={"arm_id": robot.parameters.arm_id},
            )
        super().prepare_switch(start, stop)

    @override
    def is_interrupted(self) -> bool:
        # Without a motion there is nothing to interrupt.
        if not any(robot.control_mode for robot in self.arms):
            return False
        return self.erroneous_arm() is not None or super().is_interrupted()

    @override
    def interruption_of(self, controller: ControllerInfo) -> str | None:
        own = super().interruption_of(controller)
        robot = self.erroneous_arm()
        if own is not None or robot is None or not claims_of([controller]):
            return own
        return _why_stopped(robot)


def _why_stopped(robot: FrankaCombinableHW) -> str:
    mode = robot.robot_state.robot_mode.name.lower()
    return f"arm '{robot.parameters.arm_id}' is in mode {mode}, which stops all arms"
