"""Commit subjects: which the static checks refuse."""

import runpy
import subprocess

import pytest

from tests.documentation.shell_examples import ROOT

SCRIPT = ROOT / "tools" / "check_subjects.py"


@pytest.mark.parametrize(
    ("subject", "why"),
    [
        ("api: bound the values of a body", None),
        ("hw/franka: send torques once", None),
        ("Bound the values of a body", "form"),
        ("api: Bound the values of a body", "form"),
        ("api: " + "x" * 55, None),
        ("api: " + "x" * 56, "61 characters"),
    ],
)
def test_a_subject_is_an_area_a_verb_and_short(subject, why):
    found = runpy.run_path(str(SCRIPT))["complaint"](subject)

    assert found is None if why is None else why in found


@pytest.mark.parametrize("has_tag", [True, False])
def test_subjects_since_the_last_release_are_judged_and_merges_are_not(
    tmp_path, monkeypatch, capsys, has_tag
):
    def git(*arguments):
        who = ("-c", "user.name=a", "-c", "user.email=a@b.c")
        subprocess.run(("git", *who, *arguments), check=True, capture_output=True)

    monkeypatch.chdir(tmp_path)
    git("init", "-b", "main")
    git("commit", "--allow-empty", "-m", "Before the release")
    main = runpy.run_path(str(SCRIPT))["main"]
    assert main() == 0
    if has_tag:
        git("tag", "v1")
    else:
        (tmp_path / "CHANGELOG.md").write_text("## [0.1.0] - 2026-11-25\n")
        git("add", "CHANGELOG.md")
        git("commit", "-m", "Release")
    git("commit", "--allow-empty", "-m", "api: do this")
    assert main() == 0
    git("commit", "--allow-empty", "-m", "Did that")
    assert main() == 1
    assert "'Did that'" in capsys.readouterr().err
