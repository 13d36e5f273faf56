"""A plug-in of pytest: fixtures for a robot in the test's process, and for re-runs.

```python
def test_joint_1_arrives(station):
    station.move_to({"panda_joint1": 0.3})
    assert abs(station.positions()["panda_joint1"] - 0.3) < 1e-3
```

```python
def test_the_pick_has_not_changed(rerun):
    rerun("tests/recordings/pick.mcap")   # fails at the first cycle that differs
```

Time is virtual: nothing sleeps, and every run is the same. The ini option
`station_config` or the mark `@pytest.mark.station("my.yaml")` chooses the configuration
of the station; the mark takes the arguments of `station.open`. Without either the
station is the default one.
"""

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from station.app.in_process import InProcessStation
    from station.app.rerun import RerunResult


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the ini option."""
    parser.addini("station_config", "the YAML file of the fixture `station`", "string")


def pytest_configure(config: pytest.Config) -> None:
    """Declare the mark."""
    config.addinivalue_line(
        "markers",
        "station(config, controllers=, settings=): what the fixture `station` opens",
    )


@pytest.fixture
def station(request: pytest.FixtureRequest) -> "Iterator[InProcessStation]":
    """Open a stepped station for one test; see `station.open`."""
    # Imported late: this module is imported in every run of pytest.
    from station.app.in_process import InProcessStation

    mark = request.node.get_closest_marker("station")
    arguments = () if mark is None else mark.args
    options = {} if mark is None else mark.kwargs
    if not arguments and "config" not in options:
        file = request.config.getini("station_config")
        arguments = (request.config.rootpath / file,) if file else ()
    with InProcessStation(*arguments, **options) as opened:
        yield opened


@pytest.fixture
def rerun() -> "Callable[[Path | str], RerunResult]":
    """Return a function that re-runs a recording and fails if a cycle differs."""
    from station.app.rerun import rerun as run_again

    def check(path: "Path | str") -> "RerunResult":
        result = run_again(path)
        if not result.is_equal:
            pytest.fail(result.text(), pytrace=False)
        return result

    return check
