"""The 3D view is light or dark as a whole."""

import numpy as np

from station.ui.scene.scene_views import backdrop, paint


def test_a_backdrop_is_a_gradient_without_an_edge():
    for is_dark in (False, True):
        rows = backdrop(is_dark=is_dark).astype(int)
        assert rows.shape[1:] == (2, 3)
        assert np.abs(np.diff(rows, axis=0)).max() <= 2


def test_dark_and_light_are_far_apart():
    light, dark = (backdrop(is_dark=dark).mean() for dark in (False, True))
    assert light > 200 > 70 > dark


class _Target:
    """Stands for a browser's view."""

    def __init__(self):
        self.gui = self.scene = self
        self.theme = {}
        self.image = None

    def configure_theme(self, **theme):
        self.theme = theme

    def set_background_image(self, image, **_):
        self.image = image


def test_panel_and_backdrop_change_together():
    target = _Target()
    paint(target, is_dark=True)
    assert target.theme["dark_mode"] is True
    assert (target.image == backdrop(is_dark=True)).all()
