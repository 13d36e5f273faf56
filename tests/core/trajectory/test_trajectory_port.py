"""The port's shape; what is behind it is tested with the controllers that have one."""

import pytest

from station.core.trajectory.trajectory_port import TrajectoryPort


def test_it_is_a_contract_and_nothing_to_use_by_itself():
    with pytest.raises(TypeError, match="abstract"):
        TrajectoryPort()
