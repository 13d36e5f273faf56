"""The recorded answers of the original."""

import gzip
import json
from pathlib import Path

import pytest

VECTORS = Path(__file__).parents[2] / "data" / "vectors" / "quintic.json.gz"


@pytest.fixture(scope="session")
def vectors():
    """Return `quintic.json.gz`: what the original answers, recorded by running it."""
    return json.loads(gzip.decompress(VECTORS.read_bytes()))
