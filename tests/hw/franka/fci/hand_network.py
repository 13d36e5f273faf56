"""A hand in the place of a network: a pause of the link is some cycles of the hand.

Nothing waits, and every run is the same.
"""

from station.core.description.robot_files import load_robot_files
from station.hw.franka.fci.driver.hand_link import HandLink
from station.hw.franka.fci.driver.network import FciNetworkError
from station.hw.franka.fci.driver.real_hand import RealHand
from station.hw.franka.fci.server.gripper_session import GripperSession
from station.hw.franka.hand.hand_services import HandServices
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate

CYCLES = 20


class SteppedHand:
    """A simulated hand behind the session of a server, and the driver before it."""

    def __init__(self):
        files = load_robot_files("example-robot-data:panda")
        self.world = simulate([ArmPlacement("panda", files)])
        self.robot = HandServices("panda", self.world.grippers["panda"])
        self.session = None
        self.udp_port = 4712
        self.is_absent = self.is_silent = self.is_broken = False
        self.requests = []
        self.time = 0.0
        self._cycles = 0
        self._states = []
        self._answers = bytearray()
        self.link = HandLink(self.open, clock=lambda: self.time, pause=self.pause)
        self.hand = RealHand("panda", self.link)

    def turns(self, count):
        for _ in range(count):
            self.link.serve_orders()

    def turn_until_over(self):
        """Turn until the present command has ended; return how."""
        for _ in range(200):
            self.link.serve_orders()
            if self.hand.get_state().command is None:
                break
        return self.hand.get_state().last

    def open(self):
        """Connect, as `FciNetwork` does."""
        if self.is_absent:
            raise FciNetworkError("libfranka: Connection to FCI refused at h:1338.")
        self.session = GripperSession(self.robot)
        self._answers.clear()
        return self

    def pause(self, network, longest):
        if network is None:
            self.time += longest
        else:
            self.step(CYCLES)

    def step(self, cycles):
        for _ in range(cycles):
            self.time += 0.001
            self._cycles += 1
            self.world.arms["panda"].read_once()
            self.robot.advance()
            self._answers += self.session.after_cycle()
        if not self.is_silent:
            self._states.append(self.session.state(self._cycles))

    def send(self, data):
        if self.is_broken:
            raise FciNetworkError("libfranka: TCP send bytes: broken pipe")
        self.requests.append(data[0])
        self._answers += self.session.receive(data)

    def receive(self, timeout):
        data = bytes(self._answers)
        self._answers.clear()
        return data

    def poll(self, buffer):
        if not self._states:
            return 0
        state = self._states.pop(0)
        buffer[: len(state)] = state
        return len(state)

    def wait(self, buffer):
        self.step(5)
        return self.poll(buffer)

    def close(self):
        self.session.close()
