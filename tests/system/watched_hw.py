"""A robot for tests whose arm is told to hold by a command, as a real one would be."""

from typing_extensions import override

from station.core.parameters import Parameters
from tests.app.mass_hw import MassHW

TYPE = f"{__name__}:WatchedHW"


class WatchedHW(MassHW):
    """Writes what it is commanded to a file, and holds by touching another one."""

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        super().init(root_params, hw_params)
        self._folder = hw_params.get_str("folder")

    @override
    def hold_commands(self) -> list[list[str]]:
        return [["touch", f"{self._folder}/held"], ["no-such-command-anywhere"]]
