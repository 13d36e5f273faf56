"""`station run CONFIG --controllers FILE` with the public parameter files of ROS.

One file of each package; all of them are loaded and run in `tests/app`.
"""

import pytest

from station.client import StationClient
from station.controllers import CONTROLLERS
from tests.app.test_ros_yaml import FILES, FOLDER, robot_for
from tests.system.station_process import StationProcess
from tests.waiting import wait_until

ONE_OF_EACH = {file.parent: file for file in FILES}.values()


@pytest.fixture(params=ONE_OF_EACH, ids=lambda path: str(path.relative_to(FOLDER)))
def client(request, tmp_path):
    """Run a station with the file's controllers; return a client."""
    config = tmp_path / "station.yaml"
    config.write_text(
        f"{robot_for(request.param)}controllers: {{}}\nui: {{enabled: false}}\n"
    )
    process = StationProcess(tmp_path, str(config), "--controllers", str(request.param))
    try:
        access = process.access()
        with StationClient(access["url"], access["token"]) as client:
            yield client
    finally:
        process.clean_up()


def test_every_controller_starts_and_runs(client):
    for loaded in client.controllers():
        assert loaded.type in CONTROLLERS
        client.switch_controllers(start=[loaded.name])
        cycle = client.status().cycle
        assert wait_until(lambda c=cycle: client.status().cycle >= c + 20)
        running = client.controller(loaded.name)
        assert (running.state, running.fault) == ("running", None)
        client.switch_controllers(stop=[loaded.name])
