"""The OpenAPI document of a small station, made once for all tests of a process."""

from functools import cache

from station.api.app import create_app
from station.api.auth import Authenticator
from tests.api.spring import make_station


@cache
def document():
    """Return the document; making it takes a third of a second."""
    return create_app(make_station(), Authenticator()).openapi()


def operations():
    """Return what the document says of each method and path."""
    return {
        (method.upper(), path): operation
        for path, methods in document()["paths"].items()
        for method, operation in methods.items()
    }
