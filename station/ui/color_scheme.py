"""Light and dark: the colours of the 3D view and of the panel beside it."""

import numpy as np
import viser
from numpy.typing import NDArray

_BRAND = (34, 110, 196)
_LIGHT = ((214.0, 222.0, 231.0), (246.0, 248.0, 250.0))
"""The backdrop's colours at the top and at the bottom."""
_DARK = ((30.0, 36.0, 44.0), (48.0, 56.0, 66.0))


def paint(target: viser.ViserServer | viser.ClientHandle, *, is_dark: bool) -> None:
    """Paint the backdrop and the panel.

    Args:
        target: Everybody's view, or that of one browser.
        is_dark: Whether the page around it is dark.
    """
    target.gui.configure_theme(
        dark_mode=is_dark,
        show_logo=False,
        show_share_button=False,
        brand_color=_BRAND,
    )
    target.scene.set_background_image(backdrop(is_dark=is_dark), format="png")


def backdrop(*, is_dark: bool) -> NDArray[np.uint8]:
    """Return a soft vertical gradient, shape (rows, 2, 3)."""
    rows = np.linspace(0.0, 1.0, 64)[:, None]
    top, bottom = np.array(_DARK if is_dark else _LIGHT)
    column = (1.0 - rows) * top + rows * bottom  # (64, 3)
    return np.repeat(column[:, None, :], 2, axis=1).astype(np.uint8)
