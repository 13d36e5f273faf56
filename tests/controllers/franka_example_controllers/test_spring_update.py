"""Springs are driven in usual cycles, and left to the controller in all others."""

import pytest

from station.controllers.franka_example_controllers.pose_spring import PoseSpring
from station.controllers.franka_example_controllers.spring_update import (
    DrivenSpring,
    SpringUpdate,
)
from station.core.franka.model_sources import ModelSource
from station.core.ports.set_point import SetPointPort
from station.core.toolbox.publish_timer import PublishTimer
from station.memory.doubles import put, zeros

HERE = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0.3, 0.0, 0.5, 1.0]
CORIOLIS = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
LARGEST_STEP, IS_ANGLE = 1e6, False


class Driven:
    """A spring of seven joints at rest: only the Coriolis torques are commanded."""

    def __init__(self):
        self.order = []
        self.commands = zeros(7)
        spring = PoseSpring(zeros(7), zeros(7), zeros(7), LARGEST_STEP, IS_ANGLE)
        put(spring.pose, HERE)
        spring.begin(0.0)
        self.driven = DrivenSpring(
            spring,
            ModelSource(self._write_pose),
            ModelSource(lambda _: self.order.append("jacobian")),
            ModelSource(self._write_coriolis),
            self.commands,
        )

    def _write_pose(self, result):
        self.order.append("pose")
        put(result, HERE)

    def _write_coriolis(self, result):
        self.order.append("coriolis")
        put(result, CORIOLIS)


def test_a_cycle_reads_the_pose_before_the_model_and_commands_the_torques():
    one = Driven()
    one.driven.drive()
    assert one.order == ["pose", "jacobian", "coriolis"]
    assert [*one.commands] == CORIOLIS


@pytest.mark.parametrize("news", ["none", "waiting", "void"])
def test_a_cycle_with_news_is_left_to_the_controller(news):
    springs = [Driven(), Driven()]
    port = SetPointPort([])
    if news == "waiting":
        port.post([])
    elif news == "void":
        port.clear()
    update = SpringUpdate(port, [one.driven for one in springs], PublishTimer(0.0))

    assert update.run(1.0, 0.001) is (news == "none")
    for one in springs:
        assert [*one.commands] == (CORIOLIS if news == "none" else [0.0] * 7)


def test_the_first_pose_is_published_at_a_rate():
    springs, timer = [Driven(), Driven()], PublishTimer(10.0)
    update = SpringUpdate(SetPointPort([]), [one.driven for one in springs], timer)
    update.run(1.0, 0.001)
    assert update.published is None
    timer.start(1.0, at_once=False)
    for time in (1.05, 1.101, 1.15):
        update.run(time, 0.001)
    assert update.published == (1.101, HERE)
