"""The benchmarks fit the code, and the pages that tell figures name the script."""

import re
import runpy

from tests.documentation.shell_examples import PAGES, ROOT
from tests.for_each import for_each

FOLDER = ROOT / "benchmarks"
SCRIPTS = sorted(FOLDER.glob("bench_*.py"))


@for_each("script", SCRIPTS, ids=lambda path: path.stem)
def test_benchmark_finds_all_that_it_imports(script, monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))

    found = runpy.run_path(str(script), run_name="not_run")

    assert callable(found["main"])
    assert f"benchmarks/{script.name}" in found["__doc__"]


@for_each("page", PAGES, ids=lambda page: page.name)
def test_benchmarks_that_a_page_names_exist(page):
    named = set(re.findall(r"bench_\w+\.py", page.read_text()))

    assert named <= {script.name for script in SCRIPTS}


def test_every_measured_figure_names_its_script():
    page = (ROOT / "docs" / "architecture.md").read_text()
    table = page.partition("| Fact |")[2].partition("\n\n")[0].splitlines()[2:]

    assert table
    assert all(re.search(r"`bench_\w+\.py` \|$", row) for row in table)
