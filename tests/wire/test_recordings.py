"""Wire models of recordings."""

import pytest
from pydantic import ValidationError

from station.reports import examples_of
from station.wire import Recording, RecordingRequest


def test_a_recording_without_an_error_says_so():
    values = examples_of(Recording.__doc__)[0]
    assert Recording.model_validate({**values, "error": None}).error == ""


@pytest.mark.parametrize("name", ["-x", "a/b", "../x", "x" * 81])
def test_a_name_that_is_no_part_of_a_file_name_is_refused(name):
    with pytest.raises(ValidationError):
        RecordingRequest(name=name)
