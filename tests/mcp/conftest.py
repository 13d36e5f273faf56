"""The tokens of the tests of the API."""

from tests.api.conftest import authenticator as authenticator
