"""Two joints under position control and the loop around them: ros_control's example."""

from station import core
from station.controllers import CONTROLLERS


class MyRobot(core.RobotHW):
    """Joints A and B; each is where it is commanded."""

    def __init__(self) -> None:
        super().__init__()
        self.pos, self.vel, self.eff, self.cmd = ([0.0, 0.0] for _ in range(4))
        states, commands = core.JointStateInterface(), core.PositionJointInterface()
        for index, name in enumerate("AB"):
            state = core.JointStateHandle(name, self.pos, self.vel, self.eff, index)
            states.register_handle(state)
            commands.register_handle(core.JointHandle(state, self.cmd))
        self.register_interface(states)
        self.register_interface(commands)

    def write(self, time: float, period: float) -> None:
        """Move the joints."""
        self.pos[:] = self.cmd


if __name__ == "__main__":
    robot, params, clock = MyRobot(), core.Parameters(), core.SystemClock()
    params.set("arm/type", "position_controllers/JointGroupPositionController")
    params.set("arm/joints", ["A", "B"])
    loaders = core.default_loaders(CONTROLLERS)
    manager = core.ControllerManager(robot, params, loaders, clock)
    loop = core.ControlLoop(robot, manager, clock=clock, period=0.01)
    manager.load_controller("arm")
    manager.switch_controller(core.SwitchRequest(start=["arm"]))
    manager.get_controller("arm").set_points.post([0.5, -0.5])
    loop.step(2)
    print(robot.pos)
