"""Declared services: what a declaration says, and what it refuses."""

import pytest
from typing_extensions import override

from station.core.hardware.services import (
    RobotServices,
    ServiceKind,
    find_services,
    service,
)
from tests.swing_station import SwingServices, make_swing_station


def test_the_services_are_the_declared_methods():
    assert list(SwingServices.services()) == ["set_lengths", "push", "length"]


def test_a_declaration_has_what_the_method_says():
    push = SwingServices.services()["push"]

    assert (push.kind, push.moves) == (ServiceKind.ACTION, True)
    assert push.description.startswith("Push the swing.\n\nIt does not wait")
    assert list(push.parameters) == ["impulse", "gently"]
    assert push.parameters["gently"].default is False
    assert push.returns == dict[str, float]


def test_the_description_ends_where_the_sections_begin():
    description = SwingServices.services()["set_lengths"].description

    assert description == "Set the lengths of the ropes."


@pytest.mark.parametrize(
    ("name", "path"),
    [("set_lengths", "lengths"), ("push", "push"), ("set_EE_frame", "ee_frame")],
)
def test_the_path_is_the_name_without_set(name, path):
    def method(self):
        """Do something."""

    kind = type("Named", (RobotServices,), {name: service()(method)})

    assert kind.services()[name].path == path


def test_a_method_that_is_overridden_keeps_its_declaration():
    class Gentle(SwingServices):
        @override
        def push(self, impulse, gently=True):
            return super().push(impulse, gently)

    assert Gentle.services()["push"] == SwingServices.services()["push"]


def test_a_query_has_no_parameters():
    class Wrong(RobotServices):
        @service(ServiceKind.QUERY)
        def height(self, side: str) -> float:
            """Return a height."""

    with pytest.raises(TypeError, match="'height' is a query and has parameters"):
        Wrong.services()


def test_services_are_found_in_every_interface_of_a_robot():
    robot = make_swing_station().loop.hw

    assert find_services(robot) == [robot.swing]
