"""Build the recorder of a station from its configuration, and mend what is broken."""

import importlib.util
import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from station.config import StationConfig
from station.config.errors import ConfigError
from station.core.description.robot_files import load_robot_files
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError
from station.core.facade.station import Station
from station.core.installation import install_command
from station.records.record_store import Quota, RecordStore, default_folder

if TYPE_CHECKING:
    from station.records.foxglove_server import FoxgloveServer
    from station.records.recorder import Recorder

_LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})
_PACKAGES = ("foxglove", "lz4", "mcap")


def make_recorder(
    station: Station, config: StationConfig, warn: Callable[[str], None]
) -> "Recorder | None":
    """Return the recorder of a station; None when it is to record nothing.

    Args:
        station: The station; best before its first cycle, because a recording can be
            run again only if all is known that was asked since then.
        config: Its configuration.
        warn: Takes a line about what was recovered, or why nothing can be recorded.
    """
    section = config.records
    if not section.enabled:
        return None
    missing = [one for one in _PACKAGES if importlib.util.find_spec(one) is None]
    if missing:
        warn(
            f"Nothing is recorded: {', '.join(missing)} is not installed. "
            f"Install it: {install_command('records')}"
        )
        return None
    # Imported late: the packages may be missing.
    from station.records.recorder import Recorder

    folder = Path(section.directory) if section.directory else default_folder()
    store = RecordStore(folder, Quota(section.max_bytes, section.max_count))
    incidents = None
    if section.incidents:
        incidents = RecordStore(folder / "incidents", Quota(count=section.incidents))
    for found in (store, *([incidents] if incidents else [])):
        for info in found.recover():
            warn(f"Recording {info.identifier} is {info.state}: {info.error}")
    return Recorder(station, store, incidents, texts=describe(station, config))


def start_foxglove(
    station: Station, config: StationConfig, warn: Callable[[str], None]
) -> "FoxgloveServer | None":
    """Return the server for Foxglove, started; None when it is not configured.

    Args:
        station: The station.
        config: Its configuration.
        warn: Takes a line about where it listens, or what a client wanted in vain.

    Raises:
        ConfigError: Nobody can listen at its address.
    """
    section = config.foxglove
    if not section.enabled:
        return None
    # Imported late: the package may be missing, and the command line says which.
    from station.records.foxglove_server import FoxgloveServer

    texts = describe(station, config)
    description = texts.get("/robot_description", "")
    urdf = parse_urdf(description) if description.lstrip().startswith("<") else None
    try:
        server = FoxgloveServer(
            station,
            host=section.host,
            port=section.port,
            urdf=urdf,
            texts=texts,
            warn=warn,
        )
    except RuntimeError as error:
        raise ConfigError(
            [f"foxglove: nobody can listen at {section.host}:{section.port}: {error}."],
            remedy="Give another port with --foxglove=PORT.",
        ) from error
    if section.host not in _LOOPBACK:
        warn(
            f"The Foxglove server listens at {section.host}:{server.port} without "
            "tokens: whoever reaches it may change gains and switch controllers."
        )
    return server


def describe(station: Station, config: StationConfig) -> dict[str, str]:
    """Return what a recording says of its station, by topic."""
    # The secrets of the server are nothing that a file should carry.
    secret = {"api", "ui", "watchdog", "records", "foxglove"}
    values = config.model_dump(mode="json", exclude=secret)
    values["parameters"] = json.loads(json.dumps(config.parameters, default=str))
    texts = {"/configuration": json.dumps(values)}
    parameters = station.parameters
    for path in ("robot_description", "robot/robot_description"):
        found = parameters.get(path)
        if isinstance(found, str):
            texts["/robot_description"] = _robot_text(found)
    return texts


def _robot_text(found: str) -> str:
    """Return the URDF that a parameter holds or names; the name if it has no file."""
    if found.lstrip().startswith("<"):
        return found
    try:
        return load_robot_files(found).xml
    except RobotDescriptionError:
        return found  # the name of it, which is better than nothing
