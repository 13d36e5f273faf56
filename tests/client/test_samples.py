"""Samples are arrays by quantity, and a table where pandas is installed."""

import sys

import numpy as np
import pytest

from station.client import Samples
from station.wire import StreamFrame


def frame(data, stamp=1.0):
    return StreamFrame(topic="joint_states", seq=1, epoch=1, stamp=stamp, data=data)


def batch(*stamps, lost=0):
    samples = [
        {
            "cycle": index,
            "stamp": stamp,
            "position": [stamp, -stamp],
            "effort": [None] * 2,
        }
        for index, stamp in enumerate(stamps)
    ]
    return frame({"name": ["a", "b"], "samples": samples, "lost": lost})


def test_batches_become_arrays():
    samples = Samples("joint_states")
    samples.add(batch(1.0, 2.0, lost=3))
    samples.add(batch(4.0))

    np.testing.assert_array_equal(samples.stamp, [1.0, 2.0, 4.0])
    np.testing.assert_array_equal(
        samples["position"], [[1.0, -1.0], [2.0, -2.0], [4.0, -4.0]]
    )
    assert np.isnan(samples["effort"]).all()
    assert samples["cycle"].shape == (3,)
    assert (samples.names, samples.lost, samples.duration) == (("a", "b"), 3, 3.0)
    assert "3 samples of joint_states over 3.000 s" in repr(samples)


def test_single_frames_have_the_stamp_of_the_frame():
    samples = Samples("robot_state")
    samples.add(frame({"q": [0.5], "robot_mode": "idle"}, stamp=7.0))

    np.testing.assert_array_equal(samples.stamp, [7.0])
    assert list(samples) == ["q"]


def test_what_is_too_late_is_cut():
    samples = Samples("joint_states")
    samples.add(batch(1.0, 1.5, 2.0, 2.001))

    samples.cut(1.0)

    np.testing.assert_array_equal(samples.stamp, [1.0, 1.5, 2.0])
    assert len(samples["position"]) == 3


def test_quantity_that_comes_later_has_no_value_before():
    samples = Samples("loop")
    samples.add(frame({"x": 1.0}))
    samples.add(frame({"x": 2.0, "y": [3.0, 4.0]}))

    np.testing.assert_array_equal(samples["y"], [[np.nan, np.nan], [3.0, 4.0]])


def test_table_has_a_column_per_joint():
    pandas = pytest.importorskip("pandas")
    samples = Samples("joint_states")
    samples.add(batch(1.0, 2.0))

    table = samples.frame()

    assert isinstance(table, pandas.DataFrame)
    assert list(table.columns[:2]) == ["cycle", "position/a"]
    assert table["position/b"][2.0] == -2.0


def test_without_pandas_the_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)

    with pytest.raises(ModuleNotFoundError, match="pip install pandas"):
        Samples("joint_states").frame()
