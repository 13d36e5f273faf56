"""Plot layouts on disk: saved, read, deleted, and files that cannot be used."""

import pytest

from station.core.errors import PlotLayoutError, PlotLayoutNotFoundError
from station.library.yaml_folder import PlotLayouts
from station.reports import DockSettings, PlotSettings

PLOTS = (
    PlotSettings(["position/a", "d/dt position/a"], span=30.0),
    PlotSettings(["effort/a"], xy=True, transform="norm"),
)


@pytest.fixture
def layouts(tmp_path):
    return PlotLayouts(tmp_path)


def test_a_layout_is_saved_read_and_deleted(layouts):
    saved = layouts.save("torques", PLOTS)
    assert layouts.names() == ["torques"]
    assert layouts.get("torques") == saved
    assert tuple(saved.plots) == PLOTS
    docks = DockSettings(["plots"], 468.0, 236.0, {"joints": 300.0})
    layouts.save("torques", PLOTS, docks)
    layouts.save("torques", PLOTS[:1])  # without docks, which stay
    assert layouts.get("torques").docks == docks
    assert tuple(layouts.delete("torques").plots) == PLOTS[:1]
    with pytest.raises(PlotLayoutNotFoundError, match="no plot layout 'torques'"):
        layouts.get("torques")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("plots: 3", "valid tuple"),
        ("plots: []\ndocks: {side: 3}", "folded: "),
        ("plots: [{span: 1}]", "0/keys: Field required"),
        ("plots: [{keys: [a], span: -1, xy: false, transform: ''}]", "shows -1.0 s"),
    ],
)
def test_a_malformed_file_is_refused(layouts, tmp_path, text, why):
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(PlotLayoutError, match=why):
        layouts.get("bad")
