"""The simulated arm of `station run`, stepped by hand and driven over REST."""

from station.api.app import create_app
from station.api.auth import Authenticator
from station.app.composition import compose
from station.client import StationClient
from station.config import load_config
from station.core.clock import ManualClock
from tests.api.conftest import AppTransport

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
ARM = "effort_joint_trajectory_controller"
TOKEN = "operator-token"
URL = "http://127.0.0.1:8000"
# Beside the hand, in the way of a turn of the first joint to the left.
WALL = "{name: wall, type: box, size: [0.3, 0.04, 1.0], position: [0.35, 0.2, 0.5]}"
# No reflex: what is tested with these is what a controller makes of an obstacle.
INSENSITIVE = {
    f"{side}_{what}_thresholds_{kind}": [1e3] * size
    for side in ("lower", "upper")
    for what, size in (("torque", 7), ("force", 6))
    for kind in ("acceleration", "nominal")
}


class ArmBench:
    """A station with the default configuration and its client.

    Args:
        folder: Where its configuration may be written.
        text: What is different from the default configuration, as YAML.
        files: Parameter files of controllers.
    """

    def __init__(self, folder, text="", files=()):
        path = folder / "station.yaml"
        path.write_text(text)
        config = load_config(path, controller_files=files)
        self.station = compose(config, ManualClock()).station
        app = create_app(self.station, Authenticator(TOKEN, "viewer-token"))
        self.client = StationClient(URL, TOKEN, transport=AppTransport(app))
        self.run(0.02)

    def close(self):
        """Close the client."""
        self.client.close()

    def run(self, seconds):
        """Let time pass."""
        self.station.loop.step(round(seconds * 1000))

    def start(self, name=ARM):
        """Start a controller and let it settle."""
        self.client.switch_controllers(start=[name])
        self.run(0.02)

    def positions(self):
        """Return where the joints of the arm are [rad]."""
        return list(self.client.joint_states().position[:7])

    def turned(self, *turns):
        """Return the present positions with some joints turned [rad]."""
        wanted = [*turns, *[0.0] * (7 - len(turns))]
        return [q + dq for q, dq in zip(self.positions(), wanted, strict=True)]

    def send(self, *points, name=ARM, pace=1.0, **fields):
        """Send a goal that rests at every point, `pace` seconds apart."""
        rest = [0.0] * 7
        rows = [
            {
                "positions": positions,
                "velocities": rest,
                "accelerations": rest,
                "time_from_start": pace * (index + 1),
            }
            for index, positions in enumerate(points)
        ]
        message = {"trajectory": {"joint_names": JOINTS, "points": rows}, **fields}
        return self.client.submit_goal(name, message)

    def goal(self, goal, name=ARM):
        """Return how far a goal is."""
        return self.client.goal(name, goal.id)

    def finish(self, goal, name=ARM, seconds=10.0):
        """Let time pass until a goal has ended; return how."""
        for _ in range(round(seconds / 0.01)):
            if self.goal(goal, name).status not in {"pending", "active"}:
                break
            self.run(0.01)
        return self.goal(goal, name)
