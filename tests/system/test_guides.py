"""The guides lead from an empty folder to a joint that moves."""

import pytest

from tests.system.guide import Reader

pytestmark = pytest.mark.long


def test_write_a_controller(tmp_path):
    with Reader("write_a_controller.md", tmp_path) as reader:
        reader.follow()
        reader.wait_for("shoulder", 0.5)
        reader.run_pytest()

        assert abs(reader.positions()["elbow"]) < 0.01


def test_write_a_robot(tmp_path):
    with Reader("write_a_robot.md", tmp_path) as reader:
        reader.follow()
        reader.wait_for("shoulder", 0.5)
        reader.wait_for("elbow", -0.5)
