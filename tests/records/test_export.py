"""Recordings as tables."""

import csv
import sys

import numpy as np
import pytest
from pyarrow import parquet

from station.core.control.switching import SwitchRequest
from station.core.errors import RecordingRefusedError
from station.records.recording_table import columns, export


@pytest.fixture
def path(station, recorder, store):
    """Return a recording of ten cycles, a controller running in the last five."""
    station.load_controller("arm", "test/Spring", {"joint": "j", "k": 2.0})
    recorder.start()
    station.loop.step(5)
    station.switch_controllers(SwitchRequest(start=["arm"]))
    station.loop.step(4)
    return store.file(recorder.stop().identifier)


def test_a_table_has_a_row_per_cycle(path):
    found = columns(path)

    assert found["cycle"].tolist() == list(range(1, 11))
    assert found["time"] == pytest.approx(np.arange(1, 11) * 0.001)
    assert found["joint_states/position/j"].tolist() == [0.25] * 10
    output = found["controllers/arm/output/j"]
    assert np.isnan(output[:6]).all()
    assert output[6:].tolist() == [0.0] * 4


def test_all_forms_have_the_same_numbers(path, tmp_path):
    wanted = columns(path)
    for form in ("csv", "npz", "parquet"):
        export(path, tmp_path / f"x.{form}", form)

    with (tmp_path / "x.csv").open() as file:
        head, *rows = csv.reader(file)
    table = parquet.read_table(tmp_path / "x.parquet")
    with np.load(tmp_path / "x.npz") as arrays:
        for index, (name, column) in enumerate(wanted.items()):
            assert head[index] == name
            read = [float(row[index]) for row in rows]
            for found in (read, arrays[name], table[name].to_numpy()):
                np.testing.assert_array_equal(found, column)


def test_parquet_without_its_package_is_refused_by_name(path, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(ModuleNotFoundError, match="pyarrow"):
        export(path, tmp_path / "x.parquet", "parquet")
    assert not (tmp_path / "x.parquet").exists()


def test_another_form_is_refused(path, tmp_path):
    with pytest.raises(RecordingRefusedError, match="'xls'"):
        export(path, tmp_path / "x.xls", "xls")
