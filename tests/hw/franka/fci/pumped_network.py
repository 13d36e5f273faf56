"""The driver's sockets over loopback, with the server in the same thread.

The server runs for a cycle whenever the driver waits. Nothing depends on the wall
clock: a datagram over loopback is there when it has been sent.
"""

from itertools import count

from station.hw.franka.fci.driver.network import FciNetwork
from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.hw.franka.fci.server.robot_session import ClientFeatures
from station.hw.franka.fci.wire.robot_protocol import PANDA

FEATURES = ClientFeatures()


class PumpedNetwork(FciNetwork):
    """Connects to a server that serves an arm at an address.

    Args:
        arm: The arm.
        host: Address of the server.
        hand: The services of a hand, if there is one.
        features: The versions and models of the arm.
    """

    def __init__(self, arm, host, hand=None, features=FEATURES):
        # A clock that is always late: the server polls once, and makes its cycle.
        seconds = count()
        self.server = FciServer(
            arm, hand, FciSettings(host), features, lambda: float(next(seconds))
        )
        try:
            super().__init__(host, PANDA.port)
        except OSError:
            self.server.close()
            raise

    def pump(self, cycles=1):
        left = iter(range(cycles))
        self.server.run(lambda: next(left, None) is None)

    def wait(self, buffer):
        self.pump()
        return super().wait(buffer)

    def receive(self, timeout):
        if timeout:
            self.pump(2)  # one accepts a new client, the next one serves it
        return super().receive(timeout)

    def close(self):
        super().close()
        self.server.close()
