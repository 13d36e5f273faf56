"""The direct call of MuJoCo's step is used only when it can be trusted."""

import mujoco
import pytest

from station.hw.mujoco import world
from station.hw.mujoco.world import direct_function, make_stepper

PENDULUM = """
<mujoco><worldbody><body><joint axis="0 1 0"/><geom size="0.1" pos="1 0 0"/></body>
</worldbody></mujoco>
"""


def swing(data: mujoco.MjData, step) -> list[float]:
    for _ in range(50):
        step()
    return data.qpos.tolist()


def test_direct_call_equals_the_binding_bit_for_bit() -> None:
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    direct, reference = mujoco.MjData(model), mujoco.MjData(model)
    chosen = make_stepper(model, direct)
    assert chosen.keeps_interpreter_lock
    assert swing(direct, chosen.step) == swing(
        reference, lambda: mujoco.mj_step(model, reference)
    )


@pytest.mark.parametrize("version", [0, 1])
def test_library_of_another_version_is_not_used(
    monkeypatch: pytest.MonkeyPatch, version: int
) -> None:
    monkeypatch.setattr(world.mujoco, "mj_version", lambda: version)
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    data = mujoco.MjData(model)
    chosen = make_stepper(model, data)
    assert not chosen.keeps_interpreter_lock
    chosen.step()
    assert data.time == model.opt.timestep


def test_call_that_steps_otherwise_is_not_used(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(world, "_find_function", lambda _: lambda *_: None)
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    assert not make_stepper(model, mujoco.MjData(model)).keeps_interpreter_lock


@pytest.mark.parametrize("version", [None, 0])
def test_any_function_of_model_and_data_can_be_called(
    monkeypatch: pytest.MonkeyPatch, version: int | None
) -> None:
    if version is not None:
        monkeypatch.setattr(world.mujoco, "mj_version", lambda: version)
    model = mujoco.MjModel.from_xml_string(PENDULUM)
    data = mujoco.MjData(model)
    data.qpos[0] = 0.5
    direct_function("mj_kinematics", model, data)()
    assert data.geom_xpos[0] == pytest.approx([0.8775826, 0.0, -0.4794255])
