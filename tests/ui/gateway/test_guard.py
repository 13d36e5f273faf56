"""The checks before every request; `test_gateway.py` tries them on the gateway."""

import pytest

from station.ui.gateway.guard import session_cookie


@pytest.mark.parametrize(
    ("server", "name"),
    [
        (("127.0.0.1", 8080), "station_dashboard_8080"),
        (("127.0.0.1", 8081), "station_dashboard_8081"),
        (None, "station_dashboard_0"),
    ],
)
def test_two_dashboards_on_one_machine_do_not_share_a_cookie(server, name):
    assert session_cookie({"server": server}) == name
