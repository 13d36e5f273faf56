"""A station over one simulated arm with an impedance controller, stepped by hand."""

from station.core.control.switching import SwitchRequest
from station.core.franka.arms import Arms
from tests.franka_station import JOINTS, make_franka_station


class ImpedanceStation:
    """The controller `it` runs, and its stiffness has come."""

    def __init__(self, kind, params=None, **robot):
        self.station = make_franka_station(**robot)
        params = {"arm_id": "panda", "joint_names": JOINTS, **(params or {})}
        self.station.load_controller("it", f"impedance_controllers/{kind}", params)
        self.station.switch_controllers(SwitchRequest(("it",), ()))
        self.arms = Arms(self.station.robots)
        self.run(1.5)

    def run(self, seconds):
        self.station.loop.step(round(1000 * seconds))
        assert self.station.latest().mode == "move", self.station.controller("it").fault

    def state(self):
        return self.arms.state("panda")

    def push(self, force):
        self.arms.apply_force("panda", "panda_hand", force, [0, 0, 0], 60.0)

    def set(self, **gains):
        self.station.tuning.set_gains("it", gains)
