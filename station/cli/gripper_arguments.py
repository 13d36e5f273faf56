"""The verb that commands a gripper."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.cli.arguments import Verbs


def add_gripper_verb(verbs: "Verbs") -> None:
    """Add `gripper`."""
    gripper = verbs.add(
        "gripper",
        "gripper:gripper",
        "home, open, close or stop an arm's gripper, and wait until it is done",
    )
    gripper.add_argument(
        "words",
        nargs="+",
        metavar="WORD",
        help="[ARM] state, stop, homing, move WIDTH or grasp WIDTH FORCE [m], [N]; an "
        "only arm needs no name",
    )
    gripper.add_argument(
        "--speed", type=float, default=0.1, metavar="M/S", help="how fast it opens"
    )
    for name, how in (("inner", "narrower"), ("outer", "wider")):
        gripper.add_argument(
            f"--{name}",
            type=float,
            default=0.005,
            metavar="M",
            help=f"how much {how} than WIDTH what is grasped may be",
        )
    gripper.add_argument("--no-wait", action="store_true", help="only begin")
