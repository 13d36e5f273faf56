"""Plot layouts over HTTP."""

import pytest

from station.api.app import Kept, create_app
from station.client import ApiError
from station.wire import DocksRequest, PlotRequest


@pytest.fixture
def app(station, authenticator, tmp_path):
    """Return the app with a folder of its own."""
    return create_app(station, authenticator, kept=Kept(plot_layouts=tmp_path))


def test_a_layout_is_saved_listed_read_and_deleted(client):
    plots = [PlotRequest(keys=["position/j"], span=30.0, transform="spectrum")]
    saved = client.plot_layouts.save("torques", plots)
    assert client.plot_layouts.names() == ["torques"]
    assert client.plot_layouts.get("torques") == saved
    # What was read is saved again as it is.
    assert client.plot_layouts.save("copy", saved.plots).plots == saved.plots
    docks = DocksRequest(folded=["plots"], side=468, below=236, heights={"joints": 9})
    whole = client.plot_layouts.save("whole", [], docks)
    assert (whole.docks.folded, whole.docks.heights) == (["plots"], {"joints": 9.0})
    assert client.plot_layouts.save("again", [], whole.docks).docks == whole.docks
    assert client.plot_layouts.delete("torques").plots == saved.plots
    with pytest.raises(ApiError, match="torques") as caught:
        client.plot_layouts.get("torques")
    assert caught.value.status == 404
