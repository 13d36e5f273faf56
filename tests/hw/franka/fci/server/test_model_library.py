"""The compiled model, against Pinocchio's numbers and the station's own model."""

import ctypes
import platform

import numpy as np
import pinocchio
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import Frame
from station.hw.franka.fci.server import model_library
from station.hw.franka.fci.server.model_library import (
    ModelLibraryError,
    build_model_library,
)
from station.hw.franka.fci.wire.robot_protocol import Architecture, System
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.urdf_loader import load_urdf

TOOL = [
    0.0,
    1.0,
    0.0,
    0.0,
    -1.0,
    0.0,
    0.0,
    0.0,
    0.0,
    0.0,
    1.0,
    0.0,
    0.1,
    -0.2,
    0.3,
    1.0,
]
IDENTITY = [1.0, *[0.0] * 4, 1.0, *[0.0] * 4, 1.0, *[0.0] * 4, 1.0]
INERTIA = [0.02, 0.001, 0.002, 0.001, 0.03, 0.003, 0.002, 0.003, 0.04]
MASS, CENTER = 1.7, [0.05, -0.03, 0.11]
POSES = np.random.default_rng(17).uniform(-2.0, 2.0, (5, 7))
RATES = np.random.default_rng(18).uniform(-2.0, 2.0, (5, 7))


@pytest.fixture(scope="module")
def description():
    return load_robot_files("example-robot-data:panda")


@pytest.fixture(scope="module")
def library(description, tmp_path_factory):
    """The library as libfranka would load it."""
    own = {"x86_64": Architecture.X64, "aarch64": Architecture.ARM64}
    bytes_ = build_model_library(description)[own[platform.machine()], System.LINUX]
    file = tmp_path_factory.mktemp("model") / "model.so"
    file.write_bytes(bytes_)
    return ctypes.CDLL(str(file))


def call(function, size, *arguments):
    """Call a function of the library that writes `size` numbers."""
    result = (ctypes.c_double * size)()
    converted = [
        ctypes.c_double(a) if isinstance(a, float) else (ctypes.c_double * len(a))(*a)
        for a in arguments
    ]
    function(*converted, result)
    return list(result)


@pytest.mark.parametrize("q", POSES)
def test_poses_and_jacobians_are_those_of_the_stations_model(library, description, q):
    model = ArmModel(description)
    for frame in list(Frame)[:9]:
        number = frame.value + 1
        tool = [TOOL] if frame is Frame.END_EFFECTOR else []
        at = [] if frame is Frame.JOINT1 else [q]
        given = (frame, q, TOOL, IDENTITY)
        pose = call(library[f"O_T_J{number}"], 16, q, *tool)
        assert pose == pytest.approx(model.pose(*given), abs=1e-12)
        zero = call(library[f"O_J_J{number}"], 42, *at, *tool)
        assert zero == pytest.approx(model.zero_jacobian(*given), abs=1e-12)
        body = call(library[f"Ji_J_J{number}"], 42, *at, *tool)
        assert body == pytest.approx(model.body_jacobian(*given), abs=1e-12)


@pytest.mark.parametrize(("q", "dq"), [*zip(POSES, RATES, strict=True)])
def test_dynamics_with_a_load_are_those_of_the_stations_model(
    library, description, q, dq
):
    model, load = ArmModel(description), (INERTIA, MASS, CENTER)
    mass = call(library.M_NE, 49, q, *load)
    assert mass == pytest.approx(model.mass(q, *load), abs=1e-10)
    coriolis = call(library.c_NE, 7, q, dq, *load)
    assert coriolis == pytest.approx(model.coriolis(q, dq, *load), abs=1e-10)
    earth = [0.3, -0.2, -9.7]
    gravity = call(library.g_NE, 7, q, earth, MASS, CENTER)
    assert gravity == pytest.approx(model.gravity(q, MASS, CENTER, earth), abs=1e-10)


def test_without_a_load_gravity_is_that_of_pinocchio(library, description):
    """The hand of this URDF is not part of libfranka's arm, so its mass is removed."""
    model = pinocchio.buildModelFromUrdf(str(description.urdf_path))
    last = model.joints[model.getJointId("panda_joint7")].id
    for index in range(last + 1, model.njoints):
        model.inertias[index] = pinocchio.Inertia.Zero()
    own = load_urdf(description).links["panda_link7"].inertial
    center = np.array(own.origin.xyz)
    model.inertias[last] = pinocchio.Inertia(own.mass, center, np.eye(3))
    q = np.zeros(model.nq)
    q[:7] = POSES[0]
    expected = pinocchio.computeGeneralizedGravity(model, model.createData(), q)[:7]
    found = call(library.g_NE, 7, POSES[0], [0.0, 0.0, -9.81], 0.0, [0.0] * 3)
    assert found == pytest.approx(expected, abs=1e-9)


def test_machines_of_another_kind_get_no_library(description):
    libraries = build_model_library(description)
    other = Architecture.ARM if platform.machine() == "x86_64" else Architecture.X64
    assert (other, System.LINUX) not in libraries
    assert (Architecture.X64, System.WINDOWS) not in libraries


def test_a_machine_without_a_compiler_says_so(description, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(model_library, "COMPILERS", ("no-such-compiler",))
    with pytest.raises(ModelLibraryError, match="no C compiler"):
        build_model_library(description)


def test_a_library_is_compiled_once(description, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    build_model_library(description)
    (kept,) = (tmp_path / "control-station" / "fci").iterdir()
    monkeypatch.setattr(model_library, "COMPILERS", ("no-such-compiler",))
    build_model_library(description)
    assert kept.suffix == ".so"
