"""The script of a trial: which controller runs, and what it is asked to do when.

A script is plain data, so that a file can hold it:

```yaml
controller: effort_joint_trajectory_controller
duration: 2.0
commands:
  - {kind: waypoints, joint: panda_joint1, times: [0.6, 1.2], values: [0.3, 0.0]}
  - {kind: push, link: panda_link7, at: 1.5, lasts: 0.1, force: [0, 10, 0]}
```

All values of motions are offsets from where the joint begins, and add up when several
commands name the same joint.
"""

from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from station.core.config_error import ConfigError
from station.core.errors import show
from station.core.yaml_reader import read_yaml
from station.trials.errors import ExperimentError
from station.wire.excitations import Command, Motion, Push


class Script(BaseModel):
    """The script of a trial.

    Attributes:
        controller: The controller that is started and commanded.
        duration: Length of the trial [s], > 0.
        commands: What happens; nothing but the controller's hold without commands.
        begin: Where joints begin [rad or m], by name; others at the world's start.
        settling_band: Half-width of the band of the settling time, as a share of the
            step's amplitude, 0 to 1.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    controller: str
    duration: Annotated[float, Field(gt=0.0, le=3600.0)]
    commands: Annotated[tuple[Command, ...], Field(max_length=1000)] = ()
    begin: dict[str, float] = {}
    settling_band: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.02

    @property
    def motions(self) -> tuple[Motion, ...]:
        """The commands that move joints."""
        return tuple(c for c in self.commands if not isinstance(c, Push))

    @property
    def pushes(self) -> tuple[Push, ...]:
        """The commands that push links."""
        return tuple(c for c in self.commands if isinstance(c, Push))


def parse_script(data: object, source: str = "script") -> Script:
    """Return a script from plain data.

    Args:
        data: What a file holds.
        source: What the error names.

    Raises:
        ExperimentError: The data are no script, and every reason why.
    """
    try:
        return Script.model_validate(data)
    except ValidationError as error:
        reasons = "; ".join(
            f"{'.'.join(map(str, each['loc'])) or 'script'}: {each['msg']} "
            f"(given: {show(each['input'])})"
            for each in error.errors()
        )
        raise ExperimentError(
            f"{source} is no script of a trial: {reasons}.",
            remedy="docs/experiments.md lists the commands and their fields.",
        ) from error


def read_script(path: Path) -> Script:
    """Return the script in a YAML file.

    Raises:
        ExperimentError: The file cannot be read or holds no script.
    """
    try:
        data = read_yaml(path).values
    except ConfigError as error:
        raise ExperimentError(error.message, remedy=error.remedy) from error
    return parse_script(data, str(path))
