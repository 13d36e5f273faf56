"""Read the message that an arm sends every cycle into the state of the seam."""

from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.hw.franka.arm.rigid_body import RigidBody, combine_bodies
from station.hw.franka.fci.wire.robot_protocol import RobotProtocol
from station.hw.franka.fci.wire.state_numbers import StateNumbers
from station.memory.doubles import Doubles, put, zeros

CYCLE_TIME = 0.001
"""Time from one state to the next [s]."""
_READINGS = 18  # of the accelerometers on one side of the boards
_MODES = {mode.value: mode for mode in RobotMode}


class StateReader:
    """Keeps one message, and brings the state up to date with it. Control thread.

    Args:
        state: The state to bring up to date.
        protocol: The version of the protocol.

    Attributes:
        message: Buffer for the next message.
        message_id: Number of the message that was read last.
        modes: `motion_generator_mode` and `controller_mode` of this message, as on the
            wire.
        robot_mode: Mode of the arm in the message.
    """

    def __init__(self, state: RobotState, protocol: RobotProtocol) -> None:
        self._state, self._layout = state, protocol.state
        # A byte more than a message has, so that one that is too long shows as such.
        self.message = bytearray(self._layout.size + 1)
        self._numbers = StateNumbers(self._layout, self.message, state)
        self._readings = zeros(_READINGS), zeros(_READINGS)
        places = self._layout.offsets
        self._loads = slice(places["m_ee"], places["elbow"])
        self._known_loads = b""
        self.message_id = 0
        self.modes = (0, 0)
        self.robot_mode = RobotMode.OTHER

    def is_newer(self, size: int) -> bool:
        """Return whether `message` holds a state that is newer than the last one.

        Args:
            size: How many bytes were received.
        """
        if size != self._layout.size:
            return False
        number: int = self._layout.read(self.message, "message_id")[0]
        return number > self.message_id

    def begin(self, message: bytes) -> None:
        """Read the first state of a connection, which counts its states anew.

        Args:
            message: The message.
        """
        self.message[: len(message)] = message
        self.read()

    def read(self) -> None:
        """Bring the state up to date with `message`, all but its `robot_mode`."""
        message, state, read = self.message, self._state, self._layout.read
        places = self._layout.offsets
        self._numbers.read()
        (self.message_id,) = read(message, "message_id")
        state.time = self.message_id * CYCLE_TIME
        state.current_errors[:] = read(message, "errors")
        state.last_motion_errors[:] = read(message, "reflex_reason")
        loads = bytes(message[self._loads])
        if loads != self._known_loads:
            self._known_loads = loads
            self._read_loads()
        self.modes = (
            message[places["motion_generator_mode"]],
            message[places["controller_mode"]],
        )
        self.robot_mode = _MODES.get(message[places["robot_mode"]], RobotMode.OTHER)

    def accelerometers(self) -> tuple[Doubles, Doubles] | None:
        """Return the readings on top and bottom of the boards [m/s^2], each 6 x 3.

        None in a version without them. The memory is the same at every call.
        """
        accelerations = self._numbers.accelerations
        if not accelerations[0].size:
            return None
        for target, source in zip(self._readings, accelerations, strict=True):
            put(target, source.astype(float))
        return self._readings

    def _read_loads(self) -> None:
        """Combine end effector and load, as libfranka does when it converts a state."""
        state = self._state
        total = combine_bodies(
            RigidBody(state.m_ee, (*state.F_x_Cee,), (*state.I_ee,)),
            RigidBody(state.m_load, (*state.F_x_Cload,), (*state.I_load,)),
        )
        state.m_total, state.F_x_Ctotal = total.mass, total.center_of_mass
        state.I_total = total.inertia
