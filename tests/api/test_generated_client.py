"""A client that openapi-python-client generates from the document works as it is."""

import importlib
import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.api.conftest import OPERATOR
from tests.api.test_openapi import DOCUMENT, OPERATIONS

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def generated(tmp_path_factory):
    """Return the package that was generated."""
    folder = tmp_path_factory.mktemp("generated")
    document = folder / "openapi.json"
    document.write_text(json.dumps(DOCUMENT))
    # Without its formatter, which it looks for beside the interpreter.
    settings = folder / "config.yaml"
    # It knows of bytes under one name alone.
    pictures = ("image/jpeg", "multipart/x-mixed-replace; boundary=picture")
    settings.write_text(
        json.dumps({
            "post_hooks": [],
            "content_type_overrides": dict.fromkeys(
                pictures, "application/octet-stream"
            ),
        })
    )
    command = Path(sys.executable).with_name("openapi-python-client")
    done = subprocess.run(
        [
            *(command, "generate", "--path", document, "--config", settings),
            *("--output-path", folder / "client"),
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "Warning" not in done.stdout + done.stderr
    sys.path.insert(0, str(folder / "client"))
    yield importlib.import_module("control_station_client")
    sys.path.remove(str(folder / "client"))


@pytest.fixture
def client(generated, server):
    """Return the generated client of the served station."""
    client = generated.AuthenticatedClient(base_url=server.url, token=OPERATOR)
    with client:
        yield client


def call(generated, tag, operation, client, **arguments):
    place = f"{generated.__name__}.api.{tag}.{operation}"
    module = importlib.import_module(place)
    return module.sync_detailed(client=client, **arguments)


def test_every_operation_is_generated_under_its_name(generated):
    folder = Path(generated.__file__).parent / "api"
    found = {path.stem for path in folder.glob("*/*.py")} - {"__init__"}

    assert found == {operation["operationId"] for _, operation in OPERATIONS}


def test_the_generated_client_loads_switches_tunes_and_commands(
    generated, client, station
):
    models = importlib.import_module(f"{generated.__name__}.models")

    def ask(tag, operation, **arguments):
        answer = call(generated, tag, operation, client, **arguments)
        assert answer.status_code < 300, answer.content
        return answer.parsed

    params = models.LoadRequestParamsType0.from_dict({"joint": "j", "k": 2.0})
    load = models.LoadRequest(name="spring", type_="test/Spring", params=params)
    assert ask("controllers", "load_controller", body=load).name == "spring"
    switch = models.SwitchRequest(start=["spring"])
    assert ask("controllers", "switch_controllers", body=switch).started == ["spring"]
    values = models.GainsPatchValues.from_dict({"k": 3.0})
    change = ask(
        "gains", "patch_gains", name="spring", body=models.GainsPatch(values=values)
    )
    assert change.values.to_dict() == {"k": 3.0}
    ask(
        "set_points",
        "put_command",
        name="spring",
        body=models.CommandRequest(command=[0.5]),
    )
    station.loop.step()

    sample = ask("set_points", "get_controller_state", name="spring")
    assert sample.output == [pytest.approx(0.75)]
    assert ask("controllers", "list_controllers").controllers[0].fault is None


def test_a_refusal_is_a_problem(generated, client):
    answer = call(generated, "controllers", "get_controller", client, name="nobody")

    assert answer.status_code == 404
    assert "nobody" in answer.parsed.detail
