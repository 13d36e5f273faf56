"""`station run CONFIG --controllers FILE` with the public parameter files of ROS.

One file for a Franka and one for another robot; all files of all packages are loaded
and run in `tests/app`, without a process of their own.
"""

import pytest

from station.client import StationClient
from station.controllers import CONTROLLERS
from tests.app.test_ros_yaml import FOLDER, robot_for
from tests.system.station_process import StationProcess
from tests.waiting import wait_until

pytestmark = pytest.mark.long

FILES = ["franka_control/default_controllers.yaml", "ur_gazebo/ur5_controllers.yaml"]


@pytest.fixture(params=FILES)
def client(request, tmp_path):
    """Run a station with the file's controllers; return a client."""
    file, config = FOLDER / request.param, tmp_path / "station.yaml"
    config.write_text(f"{robot_for(file)}controllers: {{}}\nui: {{enabled: false}}\n")
    process = StationProcess(tmp_path, str(config), "--controllers", str(file))
    try:
        access = process.access()
        with StationClient(access["url"], access["token"]) as client:
            yield client
    finally:
        process.clean_up()


def test_every_controller_starts_and_runs(client):
    controllers = client.controllers()
    assert controllers
    for loaded in controllers:
        assert loaded.type in CONTROLLERS
        client.switch_controllers(start=[loaded.name])
        cycle = client.status().cycle
        assert wait_until(lambda c=cycle: client.status().cycle >= c + 20)
        running = client.controller(loaded.name)
        assert (running.state, running.fault) == ("running", None)
        client.switch_controllers(stop=[loaded.name])
