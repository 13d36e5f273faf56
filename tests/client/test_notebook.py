"""What a notebook shows of a client."""

import httpx

from station.client import StationClient
from station.client.station_client import summary_html
from tests.api.conftest import OPERATOR


def test_station_is_shown_with_its_joints(served):
    with StationClient(served.url, OPERATOR) as client:
        html = client._repr_html_()

    assert f"<a href='{served.url}/docs'>" in html
    assert "<td>0.2500</td>" in html
    assert "running: nothing" in html


def test_station_that_does_not_answer_is_told():
    def refuse(request):
        raise httpx.ConnectError("<refused>", request=request)

    html = summary_html("http://a", None, httpx.MockTransport(refuse))

    assert html.endswith("no answer (&lt;refused&gt;)")
