"""Springs are commanded in every cycle, and get the target of a new set-point."""

from types import SimpleNamespace

import pytest

from station.controllers.franka_arm.cartesian_spring import (
    CartesianSpring,
    SpringUpdate,
)
from station.core.franka.model_sources import ModelSource
from station.core.ports.set_point import SetPointPort
from station.core.toolbox.publish_timer import PublishTimer
from station.memory.doubles import put, zeros

HERE = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0.3, 0.0, 0.5, 1.0]
# What a torque may change by in a cycle is 1 Nm.
CORIOLIS = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]


class Arm:
    """An arm at rest, for which only the Coriolis torques are commanded."""

    def __init__(self, *, keeps_doubles=True):
        self.order = []
        self.commands = zeros(7)
        joints = SimpleNamespace(
            commands=self.commands if keeps_doubles else None,
            set_commands=lambda commands: put(self.commands, commands),
        )
        state = SimpleNamespace(
            pose_source=lambda: ModelSource(self._write_pose),
            get_robot_state=lambda: SimpleNamespace(doubles=lambda _: zeros(7)),
        )
        model = SimpleNamespace(
            zero_jacobian_source=lambda _: ModelSource(
                lambda _: self.order.append("jacobian")
            ),
            coriolis_source=lambda: ModelSource(self._write_coriolis),
        )
        self.spring = CartesianSpring(joints, state, model, is_angle=False)
        self.spring.start_at_rest(0.0)
        self.order.clear()

    def _write_pose(self, result):
        self.order.append("pose")
        put(result, HERE)

    def _write_coriolis(self, result):
        self.order.append("coriolis")
        put(result, CORIOLIS)


@pytest.mark.parametrize("keeps_doubles", [True, False])
def test_a_cycle_reads_the_pose_before_the_model_and_commands_torques(keeps_doubles):
    arm = Arm(keeps_doubles=keeps_doubles)
    arm.spring.command_torques()
    assert arm.order == ["pose", "jacobian", "coriolis"]
    assert [*arm.commands] == CORIOLIS


@pytest.mark.parametrize("change", ["none", "waiting", "void"])
def test_a_new_set_point_sets_the_targets_before_the_springs_are_commanded(change):
    arms, port, order = [Arm(), Arm()], SetPointPort([]), []
    if change == "waiting":
        port.post([])
    elif change == "void":
        port.clear()
    springs = [arm.spring for arm in arms]

    def retarget():
        order.append([*arms[0].commands])

    update = SpringUpdate(port, retarget, springs, PublishTimer(0.0))

    update.command_springs(1.0)
    assert order == ([] if change == "none" else [[0.0] * 7])
    for arm in arms:
        assert [*arm.commands] == CORIOLIS


def test_the_first_pose_is_published_at_a_rate():
    timer = PublishTimer(10.0)
    springs = [Arm().spring, Arm().spring]
    update = SpringUpdate(SetPointPort([]), lambda: None, springs, timer)
    update.command_springs(1.0)
    assert update.published is None
    timer.start(1.0, at_once=False)
    for time in (1.05, 1.101, 1.15):
        update.command_springs(time)
    assert update.published == (1.101, HERE)
