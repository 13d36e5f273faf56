"""The colours of the page: text can be read, as WCAG 2 level AA asks."""

import re
from pathlib import Path

import pytest

STYLE = Path(__file__).parents[3] / "station" / "ui" / "static" / "page.css"
AA = 4.5
PAIRS = [
    *((ink, ground) for ink in ("text", "dim") for ground in ("bg", "card", "field")),
    *((ink, "card") for ink in ("amber", "green", "bad", "link", "marker")),
    ("on-blue", "blue"),
    ("bar-text", "bar"),
    ("bar-dim", "bar"),
    ("amber-bar", "bar"),
    ("text", "warn-bg"),
    ("bad", "bad-bg"),
]


def _colours(theme):
    """Return the colours of a theme; dark replaces some of light."""
    blocks = re.findall(r":root \{(.*?)\}", STYLE.read_text(), re.DOTALL)
    chosen = blocks[:1] if theme == "light" else blocks[:2]
    found = (re.findall(r"--([\w-]+): #([0-9a-f]{6})", block) for block in chosen)
    return {name: value for pairs in found for name, value in pairs}


def _luminance(colour):
    """Return the relative luminance of a colour, 0 to 1."""
    parts = [int(colour[i : i + 2], 16) / 255.0 for i in (0, 2, 4)]
    linear = [
        c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def _contrast(first, second):
    light, dark = sorted((_luminance(first), _luminance(second)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def test_contrast_is_that_of_the_standard():
    assert _contrast("000000", "ffffff") == pytest.approx(21.0)
    assert _contrast("777777", "ffffff") == pytest.approx(4.48, abs=0.01)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_has_enough_contrast(theme):
    colours = _colours(theme)
    low = {
        f"{ink} on {ground}": round(_contrast(colours[ink], colours[ground]), 2)
        for ink, ground in PAIRS
        if _contrast(colours[ink], colours[ground]) < AA
    }
    assert low == {}
