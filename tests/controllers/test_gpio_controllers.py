"""Outputs have what set-points say, keep it, and are published with the inputs."""

import pytest

from station.core.errors import ControllerLoadError, ParameterError
from station.testing import Bench

GPIO = "gpio_controllers/GpioCommandController"
GPIOS = {
    "flange": {
        "command_interfaces": ["vacuum", "light"],
        "state_interfaces": ["vacuum", "pressure"],
        "initial_values": {"pressure": 0.7, "light": 1.0},
    },
    "lamp": {"state_interfaces": ["is_on"]},
}
COMMANDS = {"flange": {"interfaces": ["vacuum", "light"]}}


@pytest.fixture
def bench():
    return Bench(robot_parameters={"gpios": GPIOS})


def states(bench):
    return dict(zip(bench.robot.gpios.names, bench.robot.gpios.states, strict=True))


def test_outputs_follow_set_points_and_keep_them_after_the_controller(bench):
    io = bench.load_controller(
        "io", GPIO, gpios=["flange"], command_interfaces=COMMANDS
    )
    bench.switch(["io"])
    bench.step(3)
    assert states(bench)["flange/light"] == 1.0  # a start changes nothing
    io.set_points.post([1.0, 1.0])
    bench.step(2)
    assert (states(bench)["flange/vacuum"], states(bench)["flange/light"]) == (1.0, 1.0)
    (values,) = io.published()["gpio_states"]["interface_values"]
    assert values == {"interface_names": ["pressure", "vacuum"], "values": [0.7, 1.0]}
    bench.switch([], ["io"])
    bench.step(3)
    assert states(bench)["flange/vacuum"] == 1.0


def test_an_output_has_one_owner_and_survives_a_bad_command(bench):
    io = bench.load_controller(
        "io", GPIO, gpios=["flange"], command_interfaces=COMMANDS
    )
    bench.load_controller("other", GPIO, gpios=["flange"], command_interfaces=COMMANDS)
    bench.switch(["io"])
    with pytest.raises(Exception, match="flange/vacuum"):
        bench.switch(["other"])
    io.set_points.post([1.0, 0.0])
    bench.step(2)
    io.update = lambda *_: io._outputs[0].set_command(float("nan"))
    bench.step(2)
    assert "nan" in bench.fault("io")
    assert states(bench)["flange/vacuum"] == 1.0


def test_without_command_interfaces_it_only_publishes(bench):
    parameters = {"state_interfaces": {"lamp": [{"interfaces": ["is_on"]}]}}
    io = bench.load_controller("io", GPIO, gpios=["lamp"], **parameters)
    bench.switch(["io"])
    bench.robot.gpios.states[bench.robot.gpios.names.index("lamp/is_on")] = 1.0
    bench.step()
    assert io.set_points is None
    assert io.published()["gpio_states"]["interface_groups"] == ["lamp"]
    assert io.published()["gpio_states"]["interface_values"][0]["values"] == [1.0]


def test_an_asynchronous_controller_of_outputs_works_as_well(bench):
    io = bench.load_controller(
        "io", GPIO, gpios=["flange"], command_interfaces=COMMANDS, is_async=True
    )
    bench.switch(["io"])
    io.set_points.post([1.0, 0.0])
    bench.step(5)
    assert states(bench)["flange/vacuum"] == 1.0
    assert bench.fault("io") is None


@pytest.mark.parametrize(
    ("parameters", "error", "words"),
    [
        ({"gpios": ["nothing"]}, ParameterError, "that the robot has"),
        ({"gpios": ["lamp", "lamp"]}, ParameterError, "each once"),
        (
            {
                "gpios": ["lamp"],
                "state_interfaces": {"lamp": {"interfaces": ["is_on", "is_on"]}},
            },
            ParameterError,
            "each once",
        ),
        (
            {"gpios": ["lamp"], "command_interfaces": COMMANDS},
            ParameterError,
            "each of the gpios",
        ),
        (
            {
                "gpios": ["lamp"],
                "command_interfaces": {"lamp": {"interfaces": ["is_on"]}},
            },
            ControllerLoadError,
            "lamp/is_on",
        ),
    ],
)
def test_what_is_missing_is_refused_by_its_name(bench, parameters, error, words):
    with pytest.raises(error, match=words):
        bench.load_controller("io", GPIO, **parameters)


def test_the_robot_refuses_unknown_keys_of_its_gpios():
    with pytest.raises(ParameterError, match="'hw/gpios/x/outputs' is unknown"):
        Bench(robot_parameters={"gpios": {"x": {"outputs": ["a"]}}})
