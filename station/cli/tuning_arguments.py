"""The verbs that look at and change what controllers run with."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.cli.arguments import Verbs


def add_tuning_verbs(verbs: "Verbs") -> None:
    """Add `gains`, `parameters` and `reload_controller_libraries`."""
    gains = verbs.add(
        "gains",
        "gains:gains",
        "show or set the gains of a controller; save, compare and apply sets of gains",
    )
    gains.add_argument(
        "action",
        choices=("show", "set", "list", "save", "load", "diff", "delete", "undo"),
    )
    gains.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="a controller to show or set; a gain set to save, load, diff or delete",
    )
    gains.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="set: NAME=VALUE, e.g. panda_joint1/p=500; save and load: controllers, "
        "all when left out",
    )
    parameters = verbs.add(
        "parameters",
        "parameters:parameters",
        "read and change the tree of parameters that controllers are loaded with",
    )
    parameters.add_argument("action", choices=("get", "set", "delete"))
    parameters.add_argument(
        "path", nargs="?", default="", metavar="PATH", help="e.g. arm/gains/j1/p"
    )
    parameters.add_argument(
        "value", nargs="?", metavar="VALUE", help="JSON, such as 0.5 or [1,2], or text"
    )
    reload = verbs.add(
        "reload_controller_libraries",
        "controllers:reload_controller_libraries",
        "let the next load of each type read its Python module anew",
    )
    reload.add_argument(
        "--force-kill",
        action="store_true",
        help="unload all controllers first",
    )
