"""The robots that the benchmarks run: 1, 2 and 4 arms, and 6, 7 and 29 joints."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import count
from math import cos, pi, sin
from pathlib import Path
from tempfile import TemporaryDirectory

import yaml

from station.app.composition import compose
from station.config import load_config
from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.hardware.interfaces import EffortJointInterface
from station.core.numerics.rigid_motion import numbers_of
from station.memory.doubles import doubles, zeros

EXAMPLES = Path(__file__).parents[1] / "examples"
PANDA_JOINTS = [f"joint{number}" for number in range(1, 8)]
GAINS = [(600.0, 30.0)] * 4 + [(250.0, 10.0), (150.0, 10.0), (50.0, 5.0)]
STATES = "joint_state_controller"
SENT = 20
"""Cycles from one set-point of a moving robot to the next."""
RADIUS = 0.05
"""Radius of the circle on which an end effector moves [m]."""
AMPLITUDE = 0.2
"""How far joints move to either side [rad]."""


@dataclass(frozen=True, slots=True)
class Case:
    """A robot, and what runs on it in a benchmark.

    Attributes:
        robot: How the table calls it.
        make: Builds the station.
        runs: Names of controllers that run together, by what the table calls them.
            None: every controller of the configuration, one after the other.
        steer: Returns what sends a controller its next set-point, every `SENT` cycles;
            None to let the robot rest.
    """

    robot: str
    make: Callable[[], Station]
    runs: dict[str, tuple[str, ...]] | None = None
    steer: Callable[[Station, str], Callable[[], None]] | None = None


def steer_on_a_circle(station: Station, controller: str) -> Callable[[], None]:
    """Return what sends the next pose on a circle of 5 cm, once around in 3 s."""
    state = Arms(station.robots).state("panda")
    near, numbers = doubles([0.0, 0.0, 0.0, 1.0]), zeros(7)
    numbers_of(doubles(state.O_T_EE), near, numbers)
    x, y, *rest = numbers
    angles = count(0.0, 2.0 * pi * SENT * 1e-3 / 3.0)

    def send() -> None:
        angle = next(angles)
        pose = [x + RADIUS * (cos(angle) - 1.0), y + RADIUS * sin(angle), *rest]
        station.motion.set_command(controller, pose)

    return send


def steer_joints(station: Station, controller: str) -> Callable[[], None]:
    """Return what keeps all joints of an arm moving by 0.2 rad, there and back in 4 s.

    A controller of trajectories gets a goal for each way, others a set-point each time.
    """
    names = [f"panda_{joint}" for joint in PANDA_JOINTS]
    places = [*Arms(station.robots).state("panda").q]
    calls = count()
    per_way = 2000 // SENT

    def send() -> None:
        call = next(calls)
        if "trajectory" not in controller:
            shift = AMPLITUDE * sin(pi * call / per_way)
            values = [place + shift for place in places]
            station.motion.set_command(controller, values)
        elif call % per_way == 0:
            shift = AMPLITUDE if call % (2 * per_way) == 0 else -AMPLITUDE
            point = {
                "positions": [place + shift for place in places],
                "velocities": [0.0] * len(names),
                "time_from_start": 2.0,
            }
            trajectory = {"joint_names": names, "points": [point]}
            station.motion.submit_goal(controller, {"trajectory": trajectory})

    return send


def steer_anything(station: Station, controller: str) -> Callable[[], None]:
    """Return what keeps an arm moving under a controller."""
    steer = steer_on_a_circle if "cartesian" in controller else steer_joints
    return steer(station, controller)


def station_of(values: dict[str, object]) -> Station:
    """Return the station of a configuration."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "station.yaml"
        path.write_text(yaml.safe_dump(values))
        return compose(load_config(path)).station


def make_panda() -> Station:
    """Return the station of the default configuration, with an ideal arm."""
    return station_of({"robot": {"realism": "ideal"}})


def make_typical_panda() -> Station:
    """Return the station of the default configuration."""
    return compose(load_config()).station


def make_guarded_panda() -> Station:
    """Return the ideal arm with ten objects around it that it keeps clear of."""
    objects: list[dict[str, object]] = [
        {
            "name": "table",
            "type": "box",
            "size": [0.5, 1.4, 0.2],
            "position": [0.75, 0, 0],
        },
        {"name": "ground", "type": "half_space", "position": [0, 0, -0.1]},
    ]
    for number in range(8):
        kind = ("box", "capsule", "sphere", "cylinder")[number % 4]
        size = {"box": [0.2, 0.2, 0.5], "sphere": [0.12]}.get(kind, [0.05, 0.8])
        angle = pi * (number + 0.5) / 4.0
        position = [0.75 * cos(angle), 0.75 * sin(angle), 0.6]
        objects.append({
            "name": f"{kind}{number}", "type": kind, "size": size, "position": position
        })  # fmt: skip
    scene = {"objects": [{**one, "role": "keep_out"} for one in objects]}
    return station_of({"robot": {"realism": "ideal"}, "scene": scene})


def make_dual_panda() -> Station:
    """Return two arms under the controllers of their example."""
    return compose(load_config(EXAMPLES / "dual_panda.yaml")).station


def make_pandas(count: int) -> Station:
    """Return some arms beside each other, each with an effort group controller."""
    arms = [f"panda_{number}" for number in range(1, count + 1)]
    robot: dict[str, object] = {
        "type": "franka_hw/FrankaCombinedHW",
        "robot_hardware": arms,
    }
    controllers: dict[str, object] = {}
    for number, arm in enumerate(arms):
        robot[arm] = {
            "type": "franka_hw/FrankaCombinableHW",
            "arm_id": arm,
            "robot_description": "example-robot-data:panda",
            "base_xyz": [0.0, 1.5 * number, 0.0],
        }
        joints = [f"{arm}_{joint}" for joint in PANDA_JOINTS]
        controllers[f"{arm}_effort_group"] = _effort_group(
            dict(zip(joints, GAINS, strict=True))
        )
    return station_of({"robot": robot, "controllers": controllers, "start": []})


def make_urdf_robot(description: str, height: float = 1.2) -> Station:
    """Return a robot of example-robot-data; all its motors have the same gains."""
    robot = {
        "type": "mujoco_hw/MujocoRobotHW",
        "robot_description": f"example-robot-data:{description}",
        "base_xyz": [0.0, 0.0, height],
        "gravity_compensation": True,
        "armature": 0.1,
    }
    bare = station_of({"robot": robot, "controllers": {}, "start": []})
    efforts = bare.loop.hw.get(EffortJointInterface)
    joints = [] if efforts is None else [h.name for h in efforts.handles()]
    position = "position_controllers/JointGroupPositionController"
    controllers = {
        "effort_group": _effort_group(dict.fromkeys(joints, (50.0, 5.0))),
        "position_group": {"type": position, "joints": joints},
    }
    return station_of({"robot": robot, "controllers": controllers, "start": []})


def _effort_group(gains: dict[str, tuple[float, float]]) -> dict[str, object]:
    return {
        "type": "effort_controllers/JointGroupPositionController",
        "joints": list(gains),
        **{joint: {"pid": {"p": p, "i": 0, "d": d}} for joint, (p, d) in gains.items()},
    }


def _arms(count: int) -> Case:
    names = tuple(f"panda_{number}_effort_group" for number in range(1, count + 1))
    return Case(
        f"{count} Pandas",
        lambda: make_pandas(count),
        {"none": (), "effort group": names},
    )


_MOVED: dict[str, tuple[str, ...]] = {
    "effort group position": ("effort_group_position_controller",),
    "position joint trajectory": ("position_joint_trajectory_controller",),
    "cartesian streaming": ("cartesian_streaming_controller",),
}

_GROUPS: dict[str, tuple[str, ...]] = {
    "none": (),
    "effort group": ("effort_group",),
    "position group": ("position_group",),
}

CASES: dict[str, Case] = {
    "panda": Case("Panda", make_panda),
    "typical": Case(
        "Panda that errs",
        make_typical_panda,
        {
            "none": (),
            "effort group position": ("effort_group_position_controller",),
            "position joint trajectory": ("position_joint_trajectory_controller",),
        },
    ),
    "moving": Case("Panda that moves", make_panda, _MOVED, steer_anything),
    "guarded": Case(
        "Panda that moves among 10 roles", make_guarded_panda, _MOVED, steer_anything
    ),
    "typical-moving": Case(
        "Panda that errs, moves", make_typical_panda, _MOVED, steer_anything
    ),
    "pandas2": _arms(2),
    "pandas4": _arms(4),
    "dual": Case(
        "2 Pandas, example",
        make_dual_panda,
        {
            "dual-arm impedance": (
                "joint_state_controller",
                "panda_1_state_controller",
                "panda_2_state_controller",
                "dual_arm_cartesian_impedance_example_controller",
            )
        },
    ),
    "ur5": Case("UR5, 6 joints", lambda: make_urdf_robot("ur5"), _GROUPS),
    "urdf-panda": Case(
        "Panda from its URDF", lambda: make_urdf_robot("panda"), _GROUPS
    ),
    "g1": Case(
        "Unitree G1, 29 joints", lambda: make_urdf_robot("g1_29dof_rev_1_0"), _GROUPS
    ),
}
"""Every robot by the name that chooses it."""

MISSING = (StationError, OSError, ValueError)
"""What building a robot raises whose description is not installed."""
