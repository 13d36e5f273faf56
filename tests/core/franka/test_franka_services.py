"""Services are found by the name of the arm."""

import pytest

from station.core.errors import ResourceNotFoundError
from station.core.franka import FrankaServices, FrankaServicesInterface

OPERATIONS = {name: lambda *_: None for name in FrankaServices.__abstractmethods__}


def test_services_are_found_by_arm_and_claim_nothing():
    interface = FrankaServicesInterface()
    interface.register_handle(type("Services", (FrankaServices,), OPERATIONS)("left"))

    assert interface.get_handle("left").name == "left"
    assert interface.get_claims() == []
    with pytest.raises(ResourceNotFoundError, match="resource 'right'"):
        interface.get_handle("right")
