"""Whatever a client sends, the server serves the next one and the arm keeps its limits.

A frame is a request, a command or noise: fields with numbers of all kinds, wrong sizes,
flipped bits, the end of one frame before another. A sample goes over real sockets to
the server; the long run gives the same frames to the session of a client, which is what
reads them. A simulated arm makes its cycles meanwhile.
"""

import os
import random
import socket
from collections import Counter
from contextlib import suppress
from itertools import count

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import RobotMode
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.hw.franka.fci.server.robot_session import ClientFeatures, RobotSession
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import (
    HEADER,
    PROTOCOLS,
    Command,
    MoveController,
    MoveGenerator,
)
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from tests.hw.franka.fci.server.robot_client import answers, request
from tests.waiting import PATIENCE

# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.20.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"
WILD = (0.0, -1.0, 1e-300, 1e3, -1e30, 1e308, float("inf"), float("nan"))
POSITION_ROOM = 0.05
"""How far a joint may go beyond its limit while the arm brakes [rad]."""
VELOCITY_ROOM = 1.3
"""Part of the velocity limits that a reflex may let a joint reach."""

SETTINGS = {
    Command.SET_LOAD: {},
    Command.SET_COLLISION_BEHAVIOR: {
        f"{bound}_{kind}_thresholds_{phase}": [80.0] * (7 if kind == "torque" else 6)
        for bound in ("lower", "upper")
        for kind in ("torque", "force")
        for phase in ("acceleration", "nominal")
    },
}
_RECOVER = Command.AUTOMATIC_ERROR_RECOVERY
_RECOVERY = RobotMode.AUTOMATIC_ERROR_RECOVERY
FRAMES = int(os.environ.get("FUZZED_FRAMES", "5000"))
"""Frames of each version in the long run."""


def features_of(protocol):
    """Return one version, with a library for the machines of some clients."""
    return ClientFeatures([protocol], {(0, 0): b"library"}, "<robot/>")


class Sockets:
    """A server whose clients come over the network, in the thread of the test.

    Args:
        arm: The arm.
        protocol: The version that is spoken.
    """

    def __init__(self, arm, protocol):
        self.protocol = protocol
        # A clock that is always late: the server polls once, and makes its cycle.
        seconds = count()
        self.server = FciServer(
            arm,
            None,
            FciSettings(HOST),
            features_of(protocol),
            lambda: float(next(seconds)),
        )
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind(("0.0.0.0", 0))
        self.udp.settimeout(0.0)
        self.tcp = None
        self.server_address = None
        self.message_id = 0

    @property
    def is_connected(self):
        return self.tcp is not None

    def close(self):
        self.server.close()
        self.udp.close()
        if self.tcp is not None:
            self.tcp.close()

    def run(self, cycles):
        left = iter(range(cycles))
        self.server.run(lambda: next(left, None) is None)
        self.hear()

    def connect(self):
        """Connect as a client should; return the bytes of the answer."""
        if self.tcp is not None:
            self.tcp.close()
            self.tcp = None
            self.run(2)
        self.tcp = socket.create_connection(
            (HOST, self.protocol.port), timeout=PATIENCE
        )
        left = iter(range(3))
        self.tcp.sendall(connection(self.protocol, self.udp.getsockname()[1]))
        self.server.run(lambda: next(left, None) is None)
        data = self.tcp.recv(100)
        self.tcp.settimeout(0.0)
        return data

    def send(self, data):
        """Send bytes over TCP; a server that has hung up is noticed."""
        with suppress(BlockingIOError):
            try:
                self.tcp.sendall(data)
            except (BrokenPipeError, ConnectionResetError):
                self.tcp.close()
                self.tcp = None

    def send_datagram(self, data):
        if self.server_address is not None:
            self.udp.sendto(data, self.server_address)

    def hear(self):
        """Take what has come."""
        with suppress(BlockingIOError):
            while True:
                data, self.server_address = self.udp.recvfrom(4096)
                self.message_id = int.from_bytes(data[:8], "little")
        if self.tcp is None:
            return
        with suppress(BlockingIOError):
            try:
                data = self.tcp.recv(65_536)
            except ConnectionResetError:
                data = b""
            if not data:
                self.tcp.close()
                self.tcp = None


class Session:
    """The server's side of a client without sockets; as `Sockets`."""

    def __init__(self, arm, protocol):
        self.arm, self.protocol = arm, protocol
        self.session = None
        self.message_id = 0

    @property
    def is_connected(self):
        return self.session is not None

    def close(self):
        if self.session is not None:
            self.session.close()
            self.session = None

    def run(self, cycles):
        for _ in range(cycles):
            self.message_id += 1
            if self.session is None:
                self.arm.read_once()
                continue
            self.session.before_cycle()
            self.arm.read_once()
            self.arm.refresh_state()
            self.session.after_cycle()
            self.session.state(self.message_id)

    def connect(self):
        self.close()
        self.session = RobotSession(self.arm, features_of(self.protocol))
        return self.session.receive(connection(self.protocol, 4711))

    def send(self, data):
        try:
            self.session.receive(data)
        except FciProtocolError:
            self.close()

    def send_datagram(self, data):
        self.session.receive_command(data)


def connection(protocol, udp_port):
    """Return the request with which a client connects."""
    values = {"version": protocol.version, "udp_port": udp_port}
    return request(Command.CONNECT, 1, values, protocol)


class Fuzzer:
    """A client of one version that sends what no client should.

    Args:
        version: The version that it connects with.
        seed: Where its random numbers begin.
        kind: How its frames reach the server: `Sockets` or `Session`.
    """

    def __init__(self, version, seed, kind):
        self.protocol = PROTOCOLS[version]
        self.random = random.Random(seed)
        description = load_robot_files("example-robot-data:panda")
        self.arm = simulate([ArmPlacement("panda", description)]).arms["panda"]
        self.peer = kind(self.arm, self.protocol)
        self.moved = Counter()

    def cycle(self, cycles=1):
        """Let the server run, and look whether the arm is within its limits."""
        self.peer.run(cycles)
        state, limits = self.arm.state, self.arm.limits
        for i in range(7):
            assert limits.lower[i] - POSITION_ROOM < state.theta[i]
            assert state.theta[i] < limits.upper[i] + POSITION_ROOM
            assert abs(state.dtheta[i]) < VELOCITY_ROOM * limits.velocity[i]
        if state.robot_mode is RobotMode.MOVE:
            self.moved[self.arm._modes.generator] += 1

    def fuzz(self, frames):
        """Send frames."""
        draw, peer = self.random, self.peer
        for _ in range(frames):
            if not peer.is_connected:
                peer.connect()
            is_moving = self.arm.state.robot_mode is RobotMode.MOVE
            if draw.random() < (0.9 if is_moving else 0.1):
                peer.send_datagram(self.datagram())
            else:
                peer.send(self.message())
            # A recovery lasts up to 500 cycles, and is no motion.
            is_recovering = self.arm.state.robot_mode is _RECOVERY
            self.cycle(20 if is_recovering else draw.choice((1, 1, 1, 5)))

    def message(self):
        """Return a request that may be anything."""
        draw, choice = self.random, self.random.random()
        # Most of the time the arm shall move. With thresholds and a load of chance it
        # would err at rest, and never again do anything else.
        mode = self.arm.state.robot_mode
        if mode is RobotMode.REFLEX and choice < 0.8:
            command, values = draw.choice([*SETTINGS.items(), (_RECOVER, {})])
            return request(command, 1, values, self.protocol)
        if mode is RobotMode.IDLE and choice < 0.6:
            return request(Command.MOVE, 1, self.motion(), self.protocol)
        command = draw.choice([*self.protocol.exchanges])
        fields = self.protocol.exchanges[command].request
        data = bytearray(request(command, 1, self.values(fields), self.protocol))
        if choice < 0.85:
            return data
        if choice < 0.9:
            return HEADER.pack({"command": draw.randrange(20), "size": 12})
        if choice < 0.95:
            return data[: draw.randrange(len(data))]
        return self.flipped(data)

    def motion(self):
        """Return fields of a motion that mostly is possible."""
        draw = self.random
        generator, controllers = draw.choice([*MoveGenerator]), [*MoveController]
        if generator is MoveGenerator.NONE:
            controllers = [MoveController.EXTERNAL_CONTROLLER]
        wanted = {
            "controller_mode": draw.choice(controllers),
            "motion_generator_mode": generator,
            "maximum_path_deviation": (1.0, 1.0, draw.choice((1.0, *WILD))),
            "use_async_motion_generator": draw.random() < 0.3,
            "maximum_velocity": [draw.choice((1.0, 1.0, *WILD[3:6]))] * 7,
        }
        known = self.protocol.exchanges[Command.MOVE].request.offsets
        return {name: value for name, value in wanted.items() if name in known}

    def datagram(self):
        """Return a command, or something of its kind."""
        draw, layout, state = self.random, self.protocol.command, self.arm.state
        values = self.values(layout)
        values["message_id"] = self.peer.message_id + draw.choice((0, 0, 0, 1, -3, 10))
        values["message_id"] = max(0, values["message_id"])
        if draw.random() < 0.7:  # most motions shall begin
            values |= {
                "q_c": [q + draw.gauss(0.0, 1e-6) for q in state.q_d],
                "dq_c": [draw.gauss(0.0, 1e-3) for _ in range(7)],
                "O_T_EE_c": state.O_T_EE_c,
                "O_dP_EE_c": [draw.gauss(0.0, 1e-3) for _ in range(6)],
                "tau_J_d": [draw.gauss(0.0, 0.3) for _ in range(7)],
                "valid_elbow": False,
            }
            for name in ("motion_generation_finished", "torque_command_finished"):
                values.pop(name, None)
        data = bytearray(layout.pack(values))
        choice = draw.random()
        if choice < 0.85:
            return data
        return self.flipped(data) if choice < 0.95 else data[: draw.randrange(400)]

    def values(self, layout):
        """Return fields with numbers of all kinds."""
        draw, values = self.random, layout.unpack(bytes(layout.size))
        for name, zero in values.items():
            if isinstance(zero, tuple):
                if draw.random() < 0.3 and len(zero) == 16:
                    values[name] = IDENTITY
                elif type(zero[0]) is float:
                    values[name] = [self.number() for _ in zero]
                else:
                    values[name] = [draw.random() < 0.8 for _ in zero]
            elif type(zero) is float:
                values[name] = self.number()
            else:
                values[name] = draw.randrange(2 if isinstance(zero, bool) else 6)
        return values

    def number(self):
        draw = self.random
        return draw.choice(WILD) if draw.random() < 0.1 else draw.gauss(0.0, 2.0)

    def flipped(self, data):
        for _ in range(self.random.randrange(1, 9)):
            data[self.random.randrange(len(data))] ^= 1 << self.random.randrange(8)
        return data


def survive(version, frames, kind):
    """Fuzz, and then do what a client should do."""
    fuzzer = Fuzzer(version, 1000 + version, kind)
    peer = fuzzer.peer
    try:
        fuzzer.fuzz(frames)
        answer = answers(peer.connect(), fuzzer.protocol)
        assert answer[0][2]["status"] == 0
        # With thresholds and a load of chance the arm would err at rest.
        for command, values in SETTINGS.items():
            peer.send(request(command, 2, values, fuzzer.protocol))
        peer.send(request(_RECOVER, 2, {}, fuzzer.protocol))
        fuzzer.cycle(1000)
        assert fuzzer.arm.state.robot_mode is RobotMode.IDLE
        peer.send(request(Command.MOVE, 3, {}, fuzzer.protocol))
        fuzzer.cycle(2)
        assert fuzzer.arm.state.robot_mode is RobotMode.MOVE
        assert len(fuzzer.moved) >= 2  # it was not refused all the time
    finally:
        peer.close()
    return fuzzer


@pytest.mark.parametrize(
    "version",
    [
        pytest.param(one, marks=[] if one in {5, 10} else pytest.mark.long)
        for one in PROTOCOLS
    ],
)
def test_a_thousand_frames_over_sockets_end_nothing(version):
    survive(version, 1000, Sockets)


@pytest.mark.long
@pytest.mark.parametrize("version", PROTOCOLS)
def test_a_long_run_of_frames_ends_nothing(version):
    survive(version, FRAMES, Session)
