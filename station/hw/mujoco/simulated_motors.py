"""The motors of a simulated robot, on the actuator side of its transmissions.

A real robot has actuators, and transmissions map them to joints. MuJoCo simulates
joints, so behind the actuators the transmissions are applied in the other direction:
MuJoCo's joint state becomes actuator state, and the commands of the actuators act on
MuJoCo's joints. In a cycle:

| phase | way                                                                  |
|-------|----------------------------------------------------------------------|
| read  | MuJoCo's joints -> actuator state -> joint state                     |
| write | joint commands -> actuator commands -> drives of MuJoCo's joints     |

This module carries out the first arrow of `read` and the last arrow of `write`;
`TransmissionInterfaceLoader` loads the others.
"""

from collections.abc import Mapping, Sequence

from station.core.hardware.interfaces import (
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
    EffortActuatorInterface,
    InterfaceManager,
    PositionActuatorInterface,
    VelocityActuatorInterface,
)
from station.core.hardware.transmissions import (
    ActuatorData,
    Direction,
    JointData,
    Propagation,
    Transmission,
    TransmissionHandle,
    TransmissionInfo,
)
from station.memory.doubles import Doubles, zeros

QUANTITIES = ("position", "velocity", "effort")


class SimulatedMotors:
    """State and commands of all actuators, and the maps to the simulated joints.

    Args:
        names: Names of the actuators, m of them.
        joint_names: Names of the simulated joints, n of them.
        targets: The drives' targets by quantity, shape (n,) each; written in place.

    Attributes:
        joint_state: State of the simulated joints by quantity, shape (n,) each; the
            owner fills it before `update_state`.
    """

    def __init__(
        self,
        names: Sequence[str],
        joint_names: Sequence[str],
        targets: Mapping[str, Doubles],
    ) -> None:
        self._names = list(names)
        self._joint_names = list(joint_names)
        self._targets = targets
        self._state = {quantity: zeros(len(names)) for quantity in QUANTITIES}
        self._commands = {quantity: zeros(len(names)) for quantity in QUANTITIES}
        self.joint_state = {
            quantity: zeros(len(joint_names)) for quantity in QUANTITIES
        }
        self._to_state: list[TransmissionHandle] = []
        self._to_targets: dict[str, list[TransmissionHandle]] = {
            quantity: [] for quantity in QUANTITIES
        }
        self._state_propagation = Propagation()
        self._target_propagation = dict.fromkeys(QUANTITIES, Propagation())

    def register(self, robot: InterfaceManager) -> None:
        """Offer the actuators, so that transmissions can be loaded on them."""
        states = ActuatorStateInterface()
        commands = (
            ("position", PositionActuatorInterface()),
            ("velocity", VelocityActuatorInterface()),
            ("effort", EffortActuatorInterface()),
        )
        for index, name in enumerate(self._names):
            state = ActuatorStateHandle(
                name,
                self._state["position"],
                self._state["velocity"],
                self._state["effort"],
                index,
            )
            states.register_handle(state)
            for quantity, interface in commands:
                interface.register_handle(
                    ActuatorHandle(state, self._commands[quantity], index)
                )
        robot.register_interface(states)
        for _, interface in commands:
            robot.register_interface(interface)

    def connect(self, info: TransmissionInfo, transmission: Transmission) -> None:
        """Connect the actuators of a transmission to the simulated joints.

        Args:
            info: Description of the transmission, with known actuators and joints.
            transmission: The maps of the transmission.
        """
        actuators = [self._names.index(a.name) for a in info.actuators]
        joints = [self._joint_names.index(j.name) for j in info.joints]
        state, joint_state = ActuatorData(), JointData()
        for quantity in QUANTITIES:
            values = self._state[quantity]
            state.set_quantity(quantity, [(values, i) for i in actuators])
            values = self.joint_state[quantity]
            joint_state.set_quantity(quantity, [(values, i) for i in joints])
            command, target = ActuatorData(), JointData()
            values = self._commands[quantity]
            command.set_quantity(quantity, [(values, i) for i in actuators])
            targets = self._targets[quantity]
            target.set_quantity(quantity, [(targets, i) for i in joints])
            self._to_targets[quantity].append(
                TransmissionHandle(
                    info.name,
                    transmission,
                    command,
                    target,
                    direction=Direction.ACTUATOR_TO_JOINT,
                    quantities=(quantity,),
                )
            )
            handles = self._to_targets[quantity]
            self._target_propagation[quantity] = Propagation(handles)
        self._to_state.append(
            TransmissionHandle(
                info.name,
                transmission,
                state,
                joint_state,
                direction=Direction.JOINT_TO_ACTUATOR,
                quantities=QUANTITIES,
            )
        )
        self._state_propagation = Propagation(self._to_state)

    def update_state(self) -> None:
        """Compute the actuators' state from `joint_state`. Control thread."""
        self._state_propagation.carry()

    def act(self, quantity: str) -> None:
        """Apply the actuators' commands of one quantity. Control thread.

        Args:
            quantity: "position", "velocity" or "effort".
        """
        self._target_propagation[quantity].carry()
