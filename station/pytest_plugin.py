"""A plug-in of pytest: the fixture `station`, a robot in the test's own process.

```python
def test_joint_1_arrives(station):
    station.move_to({"panda_joint1": 0.3})
    assert abs(station.positions()["panda_joint1"] - 0.3) < 1e-3
```

Time is virtual: nothing sleeps, and every run is the same. The station is that of the
ini option `station_config`, or of the mark `@pytest.mark.station("my.yaml")`, whose
arguments are those of `station.open`; without either it is the default one.
"""

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from station.app.in_process import InProcessStation


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
