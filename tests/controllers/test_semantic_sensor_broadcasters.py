"""Sensors with named values are published as the messages of ROS 2 have them."""

from math import isnan, nan

import pytest

from station.core.errors import ControllerLoadError, ParameterError
from station.testing import Bench

RANGE = "range_sensor_broadcaster/RangeSensorBroadcaster"
FIELD = "magnetometer_broadcaster/MagnetometerBroadcaster"
GPS = "gps_sensor_broadcaster/GPSSensorBroadcaster"
BATTERY = "battery_state_broadcaster/BatteryStateBroadcaster"
COVARIANCE = {
    "latitude_covariance": 1,
    "longitude_covariance": 2,
    "altitude_covariance": 3,
}
SENSORS = {
    "front": {"type": "range", "frame_id": "bumper", "values": {"range": 1.5}},
    "compass": {
        "type": "magnetometer",
        "values": {"magnetic_field.x": 1e-5, "magnetic_field.z": -4e-5},
    },
    "gps": {
        "type": "gps",
        "frame_id": "mast",
        "values": {"status": 2, "latitude": 48.1, **COVARIANCE},
    },
    "plain_gps": {"type": "gps"},
    "left": {
        "type": "battery",
        "values": {"battery_voltage": 24, "battery_current": -2, "battery_charge": 5},
    },
    "right": {"type": "battery", "values": {"battery_voltage": 20}},
}


@pytest.fixture
def publish():
    """Return a function that runs a broadcaster for a cycle."""
    bench = Bench(robot_parameters={"sensors": SENSORS})

    def run(kind, **parameters):
        controller = bench.load_controller("b", kind, **parameters)
        bench.switch(["b"])
        bench.step()
        assert bench.fault("b") is None
        return controller.published()

    run.bench = bench
    return run


def test_a_range_is_published_with_the_constants_of_the_parameters(publish):
    message = publish(RANGE, sensor_name="front", max_range=9.0, radiation_type=1)[
        "range"
    ]
    assert message == {
        "stamp": publish.bench.time,
        "frame_id": "bumper",
        "radiation_type": 1,
        "field_of_view": 0.52,
        "min_range": 0.52,
        "max_range": 9.0,
        "variance": 0.0,
        "range": 1.5,
    }


def test_a_magnetic_field_is_published_in_the_frame_of_the_parameters(publish):
    message = publish(FIELD, sensor_name="compass", frame_id="base")["magnetic_field"]
    assert message["magnetic_field"] == [1e-5, 0.0, -4e-5]
    assert message["magnetic_field_covariance"] == [0.0] * 9
    assert message["frame_id"] == "base"


def test_a_place_is_published_with_its_covariance(publish):
    message = publish(GPS, sensor_name="gps", read_covariance_from_interface=True)[
        "gps/fix"
    ]
    assert (message["latitude"], message["status"]) == (
        48.1,
        {"status": 2, "service": 0},
    )
    assert message["position_covariance"] == [1, 0, 0, 0, 2, 0, 0, 0, 3]
    assert message["position_covariance_type"] == 2


def test_batteries_are_published_each_and_as_one(publish):
    found = publish(
        BATTERY,
        batteries=["left", "right"],
        interfaces={"left": {"battery_current": True, "battery_charge": True}},
        left={"minimum_voltage": 20.0, "maximum_voltage": 25.0, "capacity": 10.0},
        right={"capacity": nan, "serial_number": "R7", "power_supply_technology": 2},
    )
    whole = found["battery_state"]
    left, right = found["raw_battery_states"]["battery_states"]
    # (24 - 20) / (25 - 20), for the one battery whose range is known.
    assert left["percentage"] == whole["percentage"] == pytest.approx(80.0)
    assert (whole["voltage"], whole["current"]) == (22.0, -2.0)
    # Of the charges only one is measured; a capacity that is not known makes no sum.
    assert whole["charge"] == 5.0
    assert isnan(whole["capacity"])
    assert isnan(right["percentage"])
    assert isnan(right["current"])
    assert (right["serial_number"], whole["power_supply_technology"]) == ("R7", 0)
    assert whole["serial_number"] == ", R7, "
    assert left["present"]
    assert whole["present"]


@pytest.mark.parametrize(
    ("kind", "parameters", "error", "words"),
    [
        (RANGE, {"sensor_name": "rear"}, ControllerLoadError, "'rear'"),
        (RANGE, {}, ParameterError, "sensor_name"),
        (FIELD, {"sensor_name": "front"}, ControllerLoadError, "'front'"),
        (
            GPS,
            {"sensor_name": "plain_gps", "read_covariance_from_interface": True},
            ControllerLoadError,
            "no value 'latitude_covariance'",
        ),
        (BATTERY, {"batteries": ["left", "left"]}, ParameterError, "each once"),
        (
            BATTERY,
            {"batteries": ["right"], "interfaces": {"right": {"battery_charge": True}}},
            ControllerLoadError,
            "no value 'battery_charge'",
        ),
        (
            BATTERY,
            {"batteries": ["right"], "right": {"capacitance": 1.0}},
            ParameterError,
            "unknown key 'capacitance'",
        ),
        (
            BATTERY,
            {
                "batteries": ["right"],
                "right": {"minimum_voltage": 3.0, "maximum_voltage": 3.0},
            },
            ParameterError,
            "above the minimum",
        ),
    ],
)
def test_what_is_missing_is_refused_by_its_name(
    publish, kind, parameters, error, words
):
    with pytest.raises(error, match=words):
        publish(kind, **parameters)
