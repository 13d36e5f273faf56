"""What OpenAPI says about errors."""

from station.api.routes.routing import MEANINGS, problems


def test_every_protected_route_may_answer_401_and_403():
    assert list(problems()) == [401, 403]
    assert list(problems(422, 404)) == [401, 403, 404, 422]


def test_every_status_is_explained():
    for status, entry in problems(*MEANINGS).items():
        assert entry["description"] == MEANINGS[status]
