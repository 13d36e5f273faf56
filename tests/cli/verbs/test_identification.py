"""The verb `identify`, in this process."""

import json

import pytest

from station.cli import main


def test_identify_prints_what_it_finds(capsys, tmp_path):
    file = tmp_path / "motion.npz"
    words = ["identify", "panda_joint7", "--with", "friction/panda_joint7=0.5"]
    assert main([*words, "--record", str(file), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)

    # The Panda's own friction comes on top: 0.25 to 0.28 Nm, after Gaz et al. 2019.
    assert found["Coulomb friction"]["value"] == pytest.approx(0.5 + 0.27, abs=0.05)
    assert main(["identify", "panda_joint7", "--recording", str(file)]) == 0
    assert "Coulomb friction  0.7" in capsys.readouterr().out
    assert main(["identify", "panda_joint7", "--recording", str(tmp_path / "no")]) == 1
