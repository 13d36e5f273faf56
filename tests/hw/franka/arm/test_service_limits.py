"""Loads and pushes outside of the range of an arm are refused with value and range."""

from math import inf, nan

import pytest

from station.core.errors import InvalidCommandError
from station.hw.franka.arm.service_limits import (
    ServiceLimits,
    check_load,
    check_vector,
)

LIMITS = ServiceLimits()
ZEROS = [0.0] * 9


@pytest.mark.parametrize("mass", [0.0, 0.5, 3.0])
def test_load_within_the_payload_is_accepted(mass):
    check_load(mass, [0.0, 0.0, 0.1], ZEROS, LIMITS)


@pytest.mark.parametrize(
    ("mass", "center", "inertia", "field"),
    [
        (500.0, ZEROS[:3], ZEROS, "mass"),
        (nan, ZEROS[:3], ZEROS, "mass"),
        (1.0, [0.0, 1e308, 1e308], ZEROS, "F_x_center_load"),
        (1.0, ZEROS[:2], ZEROS, "F_x_center_load"),
        (1.0, ZEROS[:3], [inf, *ZEROS[1:]], "load_inertia"),
        (1.0, ZEROS[:3], [1e6, *ZEROS[1:]], "load_inertia"),
    ],
)
def test_load_out_of_range_is_refused_by_field(mass, center, inertia, field):
    with pytest.raises(InvalidCommandError) as caught:
        check_load(mass, center, inertia, LIMITS)

    assert caught.value.details["errors"][0]["field"] == f"body/{field}"


def test_message_has_the_value_the_range_and_the_way_out():
    with pytest.raises(InvalidCommandError) as caught:
        check_load(500.0, ZEROS[:3], ZEROS, LIMITS)

    expected = "A load of 500.0 kg is not possible; allowed are 0 to 3 kg."
    assert caught.value.message == expected
    assert "service_limits/load_mass" in caught.value.remedy


def test_configured_payload_is_the_range():
    check_load(5.0, ZEROS[:3], ZEROS, ServiceLimits(load_mass=5.0))


@pytest.mark.parametrize(
    "values", [[1e308, 1e308, 0.0], [0.0, 400.0, 400.0], [nan, 0, 0], [1.0]]
)
def test_vector_that_is_too_long_or_not_finite_is_refused(values):
    with pytest.raises(InvalidCommandError, match=r"force of a push is .* 500 N"):
        check_vector(values, 500.0, field="force", what="force of a push", unit="N")
    check_vector([300.0, 400.0, 0.0], 500.0, field="force", what="force", unit="N")
