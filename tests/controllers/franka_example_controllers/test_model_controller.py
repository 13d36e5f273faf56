"""The model is evaluated once a second."""

import pytest

from tests.controllers.franka_example_controllers.example_station import start_example


def test_model_is_evaluated_once_a_second():
    station = start_example("Model")
    controller = station.manager.get_controller("example")
    station.loop.step(10)
    first = controller.model_sample
    station.loop.step(900)
    assert controller.model_sample is first
    station.loop.step(200)

    assert controller.model_sample is not first
    assert first.gravity == pytest.approx(station.latest().effort[:7], abs=1e-3)
    assert len(first.mass) == 49
    assert station.latest().mode == "idle"
