"""Drive the springs of a controller in the cycles in which no set-point arrives."""

from station.controllers.franka_example_controllers.pose_spring import PoseSpring
from station.core.control.usual_update import UsualUpdate
from station.core.franka.model_sources import ModelSource
from station.core.ports.set_point import SetPointPort
from station.core.toolbox.publish_timer import PublishTimer
from station.memory.doubles import Doubles
from station.memory.vectors import copy_into


class DrivenSpring:
    """A spring with what it needs in each cycle; every array is kept and not copied.

    Args:
        spring: The spring.
        pose: Writes the measured pose of the end effector.
        jacobian: Writes the Jacobian of the end effector in the axes of the base.
        coriolis: Writes the Coriolis torques.
        commands: Takes the torques [Nm], shape (n,).
    """

    def __init__(
        self,
        spring: PoseSpring,
        pose: ModelSource,
        jacobian: ModelSource,
        coriolis: ModelSource,
        commands: Doubles,
    ) -> None:
        self.spring = spring
        self.pose = pose
        self.jacobian = jacobian
        self.coriolis = coriolis
        self.commands = commands

    def drive(self) -> None:
        """Command the torques of this cycle, then move on towards the targets."""
        spring = self.spring
        self.pose.write(spring.pose)
        self.jacobian.write(spring.jacobian)
        self.coriolis.write(spring.coriolis)
        spring.run()
        copy_into(self.commands, 0, spring.torques, spring.size)


class SpringUpdate(UsualUpdate):
    """Drives all springs of a controller.

    Args:
        port: Receives the set-points.
        springs: The springs.
        timer: Tells when to publish.

    Attributes:
        published: Station time [s] and pose of the first spring's end effector, 16
            numbers, when it was published last; replaced as a whole, for any thread.
    """

    def __init__(
        self,
        port: SetPointPort,
        springs: list[DrivenSpring],
        timer: PublishTimer,
    ) -> None:
        self.port = port
        self.springs = springs
        self.timer = timer
        self.published: tuple[float, list[float]] | None = None

    def run(self, time: float, period: float) -> bool:
        """Drive the springs unless there may be another set-point."""
        if self.port.has_changed():
            return False
        self.follow(time)
        return True

    def follow(self, time: float) -> None:
        """Drive the springs.

        Args:
            time: Station time of the cycle [s].
        """
        for spring in self.springs:
            spring.drive()
        if self.timer.is_due(time):
            first = self.springs[0]
            pose = first.spring.pose
            self.published = (time, [pose[k] for k in range(16)])
