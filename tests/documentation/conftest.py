"""The API of a small station, as the tests of the API use it."""

from tests.api.conftest import app, authenticator, http, station

__all__ = ["app", "authenticator", "http", "station"]
