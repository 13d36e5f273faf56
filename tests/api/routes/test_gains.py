"""Gains: whole sets, ETags, refusals that change nothing."""

import pytest
import yaml

from station.client import ApiError
from tests.api.test_errors import problem_of

GAINS = "/api/v1/controllers/spring/gains"


@pytest.mark.usefixtures("spring")
def test_gains_come_with_schema_and_etag(operator):
    answer = operator.get(GAINS)

    assert answer.json() == {
        "values": {"k": 2.0},
        "schema": {
            "k": {
                "type": "number",
                "unit": "Nm/rad",
                "minimum": 0.0,
                "maximum": 10.0,
                "description": "",
            }
        },
        "revision": answer.json()["revision"],
        "etag": answer.headers["etag"],
    }


def test_a_change_answers_values_before_and_after(spring, station):
    change = spring.set_gains("spring", {"k": 3})

    assert change.previous == {"k": 2.0}
    assert change.values == {"k": 3.0}
    assert station.tuning.gains("spring").values == {"k": 3.0}


def test_the_etag_lets_the_first_of_two_editors_win(spring, station):
    etag = spring.gains("spring").etag
    spring.set_gains("spring", {"k": 3.0}, etag)

    with pytest.raises(ApiError) as caught:
        spring.set_gains("spring", {"k": 4.0}, etag)

    assert (caught.value.status, caught.value.code) == (412, "gains_changed")
    assert station.tuning.gains("spring").values == {"k": 3.0}
    assert spring.set_gains("spring", {"k": 4.0}, spring.gains("spring").etag)


@pytest.mark.parametrize("tag", ["*", '"x", {etag}', "{etag}"])
def test_any_of_several_etags_will_do(spring, tag):
    etag = spring.gains("spring").etag

    assert spring.set_gains("spring", {"k": 3.0}, tag.format(etag=etag)).values == {
        "k": 3.0
    }


@pytest.mark.parametrize("tag", ["1", '"1"', '"00-1"', "W/{etag}", "", "x" * 500])
def test_an_etag_of_something_else_is_refused(spring, station, tag):
    etag = spring.gains("spring").etag

    with pytest.raises(ApiError) as caught:
        spring.set_gains("spring", {"k": 3.0}, tag.format(etag=etag))

    assert caught.value.status == 412
    assert station.tuning.gains("spring").values == {"k": 2.0}


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ('{"k": NaN}', "invalid_request"),
        ('{"k": Infinity}', "invalid_request"),
        ('{"k": 1e999}', "invalid_request"),
        ('{"k": "3"}', "invalid_request"),
        ('{"k": true}', "invalid_request"),
        ('{"k": null}', "invalid_request"),
        ('{"k": [3]}', "invalid_request"),
        ("{}", "invalid_request"),
        ("[3]", "invalid_request"),
        ('{"k": -0.1}', "invalid_gain"),
        ('{"k": 10.1}', "invalid_gain"),
        ('{"k": 1e300}', "invalid_gain"),
        ('{"q": 1}', "invalid_gain"),
        ('{"k": 3, "q": 1}', "invalid_gain"),
    ],
)
@pytest.mark.usefixtures("spring")
def test_gains_with_one_bad_value_change_nothing(operator, station, values, code):
    answer = operator.patch(
        GAINS,
        content=f'{{"values": {values}}}',
        headers={"Content-Type": "application/json"},
    )

    problem = problem_of(answer, 422, code)
    assert problem["errors"][0]["field"]
    assert station.tuning.gains("spring").values == {"k": 2.0}


def test_gains_of_an_unknown_controller(spring):
    with pytest.raises(ApiError) as caught:
        spring.gains("nobody")
    assert caught.value.status == 404

    with pytest.raises(ApiError) as caught:
        spring.set_gains("nobody", {"k": 1.0}, "*")
    assert caught.value.status == 404


@pytest.mark.usefixtures("spring")
def test_the_configuration_has_the_tuned_gains_and_is_yaml(operator):
    operator.patch(GAINS, json={"values": {"k": 3.0}})

    answer = operator.get("/api/v1/controllers/spring/config.yaml")

    assert answer.headers["content-type"].startswith("text/plain")
    assert yaml.safe_load(answer.text)["spring"] == {
        "type": "test/Spring",
        "joint": "j",
        "k": 3.0,
    }


def test_a_client_downloads_the_configuration(spring, tmp_path):
    file = spring.download_config("spring", tmp_path / "spring.yaml")

    assert yaml.safe_load(file.read_text())["spring"]["k"] == 2.0
    with pytest.raises(FileExistsError):
        spring.download_config("spring", file)
