"""The table of controllers points at classes that exist."""

import importlib

from station.controllers import CONTROLLERS
from station.core.control.controller import ControllerBase
from tests.for_each import for_each


@for_each("controller_type", CONTROLLERS)
def test_every_type_names_a_controller_class(controller_type):
    module, name = CONTROLLERS[controller_type].split(":")
    controller_class = getattr(importlib.import_module(module), name)
    assert issubclass(controller_class, ControllerBase)
    assert name.endswith(controller_type.split("/")[1])
