"""The client's side of the protocol for one session, without sockets."""

from types import MappingProxyType

from station.hw.franka.fci.server.robot_session import ClientFeatures, RobotSession
from station.hw.franka.fci.wire.messages import Messages
from station.hw.franka.fci.wire.robot_protocol import (
    PANDA,
    PROTOCOLS,
    Command,
    MoveController,
    MoveGenerator,
)

UDP_PORT = 4711


def request(command, command_id, values=None, protocol=PANDA):
    """Return a request as bytes."""
    return Messages(protocol).request(command, command_id, values or {})


def answers(data, protocol=PANDA):
    """Return (command, command_id, fields) of every answer in some bytes."""
    found = Messages(protocol).answers(data)
    return [(one.command, one.command_id, one.values) for one in found]


def statuses(data, protocol=PANDA):
    """Return the status of every answer in some bytes."""
    return [one.status for one in Messages(protocol).answers(data)]


class RobotClient:
    """Talks to a session as libfranka does, one cycle after the other.

    Args:
        arm: The arm behind the session.
        libraries: The model libraries.
        version: The version that is spoken.
        robot_model: The URDF of the arm.
    """

    def __init__(self, arm, libraries=MappingProxyType({}), version=5, robot_model=""):
        self.arm = arm
        self.protocol = PROTOCOLS[version]
        features = ClientFeatures([self.protocol], libraries, robot_model)
        self.session = RobotSession(arm, features)
        self.ids = 0
        self.messages = 0
        self.received = []

    def ask(self, command, **values):
        """Send a request; return the statuses of the answers that come at once."""
        self.ids += 1
        data = request(command, self.ids, values, self.protocol)
        return self.hear(self.session.receive(data))

    def hear(self, data):
        """Note answers; return their statuses."""
        self.received += answers(data, self.protocol)
        return statuses(data, self.protocol)

    def connect(self, version=None):
        version = self.protocol.version if version is None else version
        return self.ask(Command.CONNECT, version=version, udp_port=UDP_PORT)

    def move(self, controller=None, generator=None, **more):
        """Ask for a motion; by default for positions with joint impedance."""
        controller = (
            MoveController.JOINT_IMPEDANCE if controller is None else controller
        )
        generator = MoveGenerator.JOINT_POSITION if generator is None else generator
        return self.ask(
            Command.MOVE,
            controller_mode=controller,
            motion_generator_mode=generator,
            maximum_path_deviation=(10.0, 3.12, 6.28),
            maximum_goal_pose_deviation=(10.0, 3.12, 6.28),
            **more,
        )

    def send(self, message_id=None, **values):
        """Send a command, as the answer to the newest state."""
        number = self.messages if message_id is None else message_id
        self.session.receive_command(
            self.protocol.command.pack({"message_id": number, **values})
        )

    def cycle(self):
        """Let a cycle pass; return (the state, statuses of answers that came)."""
        data = self.session.before_cycle()
        self.arm.read_once()
        data += self.session.after_cycle()
        self.messages += 1
        state = self.protocol.state.unpack(self.session.state(self.messages))
        return state, self.hear(data)
