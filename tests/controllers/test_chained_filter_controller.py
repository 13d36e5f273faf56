"""States of joints, sensors and controllers are filtered and exported."""

import pytest

from station.core.control.chainable_controller import ExportedStateInterface
from station.core.control.controller import MultiInterfaceController
from station.core.errors import ControllerLoadError, ParameterError
from station.testing import Bench

FILTER = "chained_filter_controller/ChainedFilter"


def mean(size):
    kind = {"name": "mean", "type": "filters/MeanFilterDouble"}
    return {"filter1": {**kind, "params": {"number_of_observations": size}}}


class Reader(MultiInterfaceController):
    """Keeps what it reads."""

    required_interfaces = (ExportedStateInterface,)

    def init(self, hw, params):
        names = params.get_str_list("names")
        states = hw.get(ExportedStateInterface)
        self.handles = [states.get_handle(name) for name in names]
        self.read = []

    def update(self, time, period):
        self.read.append([handle.get_value() for handle in self.handles])


@pytest.fixture
def bench():
    sensors = {"eye": {"type": "range", "values": {"range": 3.0}}}
    return Bench(robot_parameters={"sensors": sensors})


def test_each_input_is_filtered_and_a_missing_reading_is_left_out(bench):
    bench.load_controller(
        "smooth",
        FILTER,
        input_interfaces=["eye/range", "joint1/position", "mock_wrench/force.x"],
        output_interfaces=["eye/smooth", "joint1/smooth", "fx"],
        filter_chain=mean(2),
    )
    names = ["smooth/eye/smooth", "smooth/joint1/smooth", "smooth/fx"]
    reader = bench.load_controller("reader", Reader, names=names)
    bench.switch(["smooth", "reader"])
    eye = bench.robot.sensor_values["eye"]
    for value in (3.0, 5.0, float("inf"), 7.0):
        eye[0] = value
        bench.step()
    # Filters before readers, in one cycle; the cycle of the start is no update.
    assert [row[0] for row in reader.read[-4:]] == [3.0, 4.0, 4.0, 6.0]
    (chain,) = [c for c in bench.manager.chains().controllers if c.name == "smooth"]
    assert [each.name for each in chain.states] == names
    assert chain.states[0].users == ("reader",)


def test_each_input_may_have_filters_of_its_own_and_filters_can_be_chained(bench):
    inputs = ["eye/range", "joint1/position"]
    bench.load_controller(
        "first",
        FILTER,
        input_interfaces=inputs,
        output_interfaces=["a", "b"],
        eye={"range": {"filter_chain": mean(1)}},
        joint1={"position": {"filter_chain": mean(3)}},
    )
    second = bench.load_controller(
        "second",
        FILTER,
        input_interfaces=["first/a"],
        output_interfaces=["c"],
        filter_chain=mean(1),
    )
    bench.switch(["first", "second"])
    bench.step(2)
    (exported,) = second.on_export_state_interfaces()
    assert exported.storage[0] == 3.0
    (chain,) = [c for c in bench.manager.chains().controllers if c.name == "first"]
    assert [each.users for each in chain.states] == [("second",), ()]
    with pytest.raises(Exception, match="claimed by second"):
        bench.manager.unload_controller("first")


def test_a_restart_keeps_what_the_filters_know(bench):
    filtered = bench.load_controller(
        "f",
        FILTER,
        input_interfaces=["eye/range"],
        output_interfaces=["a"],
        filter_chain=mean(2),
    )
    bench.switch(["f"])
    bench.step()
    bench.switch(stop=["f"])
    bench.robot.sensor_values["eye"][0] = 5.0
    bench.switch(["f"])
    bench.step()
    (exported,) = filtered.on_export_state_interfaces()
    assert exported.storage[0] == (3.0 + 5.0) / 2


@pytest.mark.parametrize(
    ("parameters", "error", "words"),
    [
        ({"input_interfaces": []}, ParameterError, "at least one"),
        ({"output_interfaces": ["a", "b"]}, ParameterError, "one name for each"),
        ({"input_interfaces": ["eye/rang"]}, ControllerLoadError, "eye/rang"),
        ({"filter_chain": None}, ControllerLoadError, "eye/range/filter_chain"),
        (
            {"filter_chain": {"filter1": {"type": "filters/NoFilterDouble"}}},
            ParameterError,
            "filter1/type",
        ),
    ],
)
def test_what_is_missing_is_refused_by_its_name(bench, parameters, error, words):
    good = {
        "input_interfaces": ["eye/range"],
        "output_interfaces": ["a"],
        "filter_chain": mean(2),
    }
    given = {k: v for k, v in {**good, **parameters}.items() if v is not None}
    with pytest.raises(error, match=words):
        bench.load_controller("f", FILTER, **given)
