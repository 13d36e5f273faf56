"""Guard that keeps a Franka arm clear of its scene, and the capsules of its links."""

from collections.abc import Callable, Mapping, Sequence
from math import isfinite

from typing_extensions import override

from station.core.description.urdf import Pose
from station.core.errors import InvalidCommandError
from station.core.franka.franka_robot_state import RobotState
from station.core.geometry.capsules import LinkCapsule, enclosing_capsules
from station.core.geometry.clearances import Clearances
from station.core.geometry.guard import CANNOT_STOP, PASSES, SLOWED, Guard
from station.core.geometry.scene import HAND, SceneObject, solid_of
from station.core.numerics.arm_chain import new_links, place_links
from station.core.numerics.poses import quaternion_of
from station.core.numerics.rigid_motion import displace
from station.hw.franka.arm.arm_description import joint_names
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.franka_kinematics import CHAIN, FLANGE_OFFSET
from station.hw.franka.commands.command_sender import CommandSender
from station.hw.franka.commands.rate_limiter import PERIOD, rate_limits_of
from station.hw.link_guard import LinkGuard
from station.memory.doubles import doubles, put

# One or two capsules for each link, the smallest around the hulls of its collision
# meshes, with the fingers both open and closed; rounded, and each radius a little
# larger. The capsules of hand and fingers are in the frame of link 7. The base, link 0,
# does not move.
CAPSULES = (
    LinkCapsule("link1", (0.0003, -0.046, -0.0701), (0.0003, -0.046, -0.004), 0.0843),
    LinkCapsule("link1", (-0.0044, 0.0003, -0.1359), (0.0026, 0.0003, -0.1359), 0.0791),
    LinkCapsule(
        "link2", (-0.0003, -0.1471, -0.0209), (-0.0001, -0.0022, 0.0689), 0.0897
    ),
    LinkCapsule("link3", (0.083, 0.0576, -0.0045), (0.0031, -0.0046, -0.0651), 0.083),
    LinkCapsule("link4", (0.0028, 0.002, 0.0603), (-0.0805, 0.0664, -0.0032), 0.083),
    LinkCapsule("link5", (-0.0019, -0.0087, -0.2033), (0.0003, 0.0861, 0.0003), 0.0855),
    LinkCapsule("link6", (0.0199, 0.0093, 0.0001), (0.088, 0.0093, 0.0001), 0.0754),
    LinkCapsule("link7", (0.0338, 0.035, 0.0762), (-0.0048, -0.0045, 0.0743), 0.0499),
    LinkCapsule("hand", (-0.0646, -0.0643, 0.1273), (0.0547, 0.054, 0.1301), 0.0478),
    LinkCapsule(
        "fingers", (0.0417, 0.0416, 0.1923), (-0.0416, -0.0417, 0.1923), 0.0294
    ),
)
_OF_HAND = ("hand", "fingers")


class ArmGuard(LinkGuard):
    """Keeps one Franka arm clear of its scene.

    Args:
        arm_id: Name of the arm.
        base: Pose of the arm's base in the world.
        has_hand: Whether a hand is mounted.
        limits: Limits of this kind of arm.
        state: The arm's state.
        sender: Sends the commands of the arm.

    Attributes:
        guard: Computes the slowed commands.
        arm_id, base: As given.
    """

    def __init__(
        self,
        arm_id: str,
        base: Pose,
        *,
        has_hand: bool,
        limits: ArmLimits,
        state: RobotState,
        sender: CommandSender,
    ) -> None:
        super().__init__(arm_id, base)
        self._sender = sender
        self._own = [one for one in CAPSULES if has_hand or one.link not in _OF_HAND]
        self._names = [*dict.fromkeys(one.link for one in self._own)]
        self._q = state.doubles("q")
        capsules = self._own
        rates = rate_limits_of(limits)
        fields = (
            "q_d", "dq_d", "ddq_d", "q", "dq", "tau_J_d", "O_T_EE_c", "O_dP_EE_c",
            "O_ddP_EE_c",
        )  # fmt: skip
        self.guard = Guard(
            Clearances(
                CHAIN,
                [number for one in capsules for number in one.numbers()],
                _owners(capsules),
            ),
            [one.link for one in capsules],
            {name: state.doubles(name) for name in fields},
            velocity=[one.velocity for one in rates],
            acceleration=[one.acceleration for one in rates],
            jerk=[one.jerk for one in rates],
            torque_step=limits.torque_rate * PERIOD,
            translation=[
                limits.translation.velocity,
                limits.translation.acceleration,
                limits.rotation.velocity,
                limits.rotation.acceleration,
            ],
            period=PERIOD,
        )

    def add_neighbour(self, other: "ArmGuard") -> None:
        """Add another arm, which counts if the scene gives a margin for arms.

        Args:
            other: The other arm.
        """
        point = SceneObject("base", "sphere", (1.0,)).at(other.base)
        row = solid_of(point, self.base, [])
        place = [*row[1:4], 0.0, *row[4:7], 0.0, *row[7:10], 0.0, *row[10:13], 1.0]
        self.guard.add_neighbour(other.guard, doubles(place), other.arm_id)

    @override
    def hand(self) -> Pose:
        links = new_links(CHAIN)
        place_links(CHAIN, self._q, links)
        flange = [*links[-16:]]
        x, y, z, w = quaternion_of(flange)
        px, py, pz = flange[12:15]
        return self.base.compose(Pose((px, py, pz), (w, x, y, z)))

    @override
    def carry(self, objects: Sequence[SceneObject]) -> Callable[[], None]:
        flange = Pose((0.0, 0.0, FLANGE_OFFSET))
        carried = [
            capsule
            for one in objects
            if one.carried_by == self.arm_id
            for capsule in enclosing_capsules(one, flange.compose(one.grip))
        ]
        capsules = [*self._own, *carried]
        numbers = [number for one in capsules for number in one.numbers()]
        owners = [*_owners(self._own), *([6] * len(carried))]
        clearances = Clearances(CHAIN, numbers, owners)

        def apply() -> None:
            self.guard.take(clearances, [one.link for one in capsules])

        return apply

    @override
    def positions(self) -> Mapping[str, float]:
        return dict(zip(joint_names(self.arm_id), self._q, strict=True))

    @override
    def watch(self, *, is_active: bool) -> None:
        self._sender.keep_clear(self.guard if is_active else None)

    @override
    def links(self) -> Sequence[str]:
        return [*self._names, HAND]

    @override
    def links_of(self, name: str, carried: Sequence[str] = ()) -> Sequence[str]:
        short = name.removeprefix(f"{self.arm_id}_")
        if short == HAND:
            return [*_OF_HAND, *carried]
        return [short] if short in self._names else []


def _owners(capsules: Sequence[LinkCapsule]) -> list[int]:
    """Return the index of the link that each capsule of the arm is fixed to."""
    return [
        6 if one.link in _OF_HAND else int(one.link.removeprefix("link")) - 1
        for one in capsules
    ]


def slowed(guard: Guard, field: str, values: Sequence[float]) -> list[float]:
    """Return a command of an external client, slowed as the guard requires.

    Args:
        guard: The arm's guard.
        field: Name of the command: `tau_J_d`, `q_c`, `dq_c`, `O_T_EE_c` or `O_dP_EE_c`.
        values: The numbers of the command.

    Raises:
        InvalidCommandError: The arm has to stop at once to stay clear.
    """
    # The arm refuses such a command itself; the guard would compute with NaN.
    if not all(isfinite(value) for value in values):
        return [*values]
    memory, verdict = doubles(values), PASSES
    match field:
        case "q_c":
            guard.limit_positions(memory)
        case "dq_c":
            guard.limit_velocities(memory)
        case "tau_J_d":
            verdict = PASSES if guard.limit_torques(memory) else CANNOT_STOP
        case "O_T_EE_c":
            verdict = guard.limit_pose(memory)
            if verdict == SLOWED:
                displace(guard.memory[field], guard.twist, PERIOD, memory)
        case _:
            verdict = guard.limit_twist(memory)
            if verdict == SLOWED:
                put(memory, guard.twist)
    if verdict == CANNOT_STOP:
        raise InvalidCommandError(guard.reflex(), remedy="Move away.")
    return [*memory]
