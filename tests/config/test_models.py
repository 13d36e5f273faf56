"""The models take what a configuration may hold and keep foreign parameters."""

import pytest
from pydantic import ValidationError

from station.config.loading import load_config
from station.config.models import ApiSection, LoopSection
from station.core.errors import ConfigError


@pytest.mark.parametrize("rate", [0.5, 1e5, True, "1000", float("nan"), float("inf")])
def test_impossible_rate_is_refused(rate):
    with pytest.raises(ValidationError):
        LoopSection(
            rate=rate,
            real_time_factor=1.0,
            update_budget=None,
            controller_modules=[],
        )


@pytest.mark.parametrize("token", ["short", "has space in it", "umlaut-ä-in-it"])
def test_token_that_no_header_can_carry_is_refused(token):
    with pytest.raises(ValidationError):
        ApiSection(host="127.0.0.1", port=0, token=token)


def test_parameters_keep_their_types_and_order():
    config = load_config()

    controllers = config.controller_parameters()

    assert next(iter(controllers)) == "joint_state_controller"
    assert controllers["joint_state_controller"] == {
        "type": "joint_state_controller/JointStateController",
        "publish_rate": 50,
    }
    assert config.robot_parameters() == {
        "type": "franka_hw/FrankaHW",
        "arm_id": "panda",
        "robot_description": "example-robot-data:panda",
        "realtime_config": "ignore",
    }


@pytest.mark.parametrize("given", ["certificate", "key"])
def test_half_of_tls_is_refused_with_its_place(tmp_path, given):
    path = tmp_path / "station.yaml"
    path.write_text(f"api: {{tls: {{{given}: a.pem}}}}")

    with pytest.raises(ConfigError, match="both certificate and key, or neither"):
        load_config(path)


def test_tls_is_set_by_flags():
    flags = {"api.tls.certificate": "a.crt", "api.tls.key": "a.key"}
    tls = load_config(flags=flags).api.tls

    assert (tls.certificate, tls.key) == ("a.crt", "a.key")
    assert load_config().api.tls.certificate is None
