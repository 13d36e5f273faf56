"""An arm in the place of a network: a wait for a state is a cycle of the arm.

Nothing waits, and every run is the same.
"""

from station.hw.franka.fci.server.robot_session import ClientFeatures, RobotSession
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import PANDA


class SteppedNetwork:
    """Joins the driver to the session of a server, without sockets.

    Args:
        arm: The arm behind the session.
        protocol: The version that the session speaks.
    """

    def __init__(self, arm, protocol=PANDA):
        self.arm = arm
        self.session = RobotSession(arm, ClientFeatures([protocol]))
        self.udp_port = 4711
        self.messages = 0
        self.is_silent = self.is_closed = False
        self.datagrams = []
        self._answers = bytearray()

    def send(self, data):
        try:
            self._answers += self.session.receive(data)
        except FciProtocolError as error:
            self._answers += error.answers

    def receive(self, timeout):
        if self.is_closed:  # what `select` says of a closed socket
            raise ValueError("file descriptor cannot be a negative integer (-1)")
        data = bytes(self._answers)
        self._answers.clear()
        return data

    def send_datagram(self, data):
        self.datagrams.append(bytes(data))
        self.session.receive_command(bytes(data))

    def wait(self, buffer):
        self._answers += self.session.before_cycle()
        self.arm.read_once()
        self._answers += self.session.after_cycle()
        self.messages += 1
        if self.is_silent:
            return 0
        self.arm.refresh_state()
        state = self.session.state(self.messages)
        buffer[: len(state)] = state
        return len(state)

    def poll(self, buffer):
        return 0

    def close(self):
        self.is_closed = True
        self.session.close()
