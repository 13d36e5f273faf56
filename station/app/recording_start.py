"""Build the recorder of a station from its configuration, and repair broken files."""

import importlib.util
import json
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from station.app.addresses import host_names, is_loopback
from station.config import StationConfig
from station.core.description.robot_files import load_robot_files
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError
from station.core.facade.station import Station
from station.core.installation import install_command
from station.records.record_store import Quota, RecordStore, default_folder
from station.web.host_policy import HostPolicy

if TYPE_CHECKING:
    from fastapi import FastAPI

    from station.api.tool_port import ToolPort
    from station.config.models import ToolPortSection
    from station.records.recorder import Recorder

_PACKAGES = ("foxglove", "lz4", "mcap")


def make_recorder(
    station: Station, config: StationConfig, warn: Callable[[str], None]
) -> "Recorder | None":
    """Return the recorder of a station; None if it cannot or must not record.

    Args:
        station: The station, if possible before its first cycle: a recording can be
            re-run only if it has all inputs since then.
        config: Its configuration.
        warn: Called with a line about a recovery, or with the reason why recording is
            impossible.
    """
    section = config.records
    if not section.enabled:
        return None
    # Only look the packages up, and warn: a missing package must not keep the station
    # from starting.
    missing = [one for one in _PACKAGES if importlib.util.find_spec(one) is None]
    if missing:
        warn(
            f"Nothing is recorded: {', '.join(missing)} is not installed. "
            f"Install it: {install_command('records')}"
        )
        return None
    # Imported late, because the packages may be missing.
    from station.records.recorder import Recorder

    folder = Path(section.directory) if section.directory else default_folder()
    store = RecordStore(folder, Quota(section.max_bytes, section.max_count))
    incidents = None
    if section.incidents:
        quota = Quota(count=section.incidents)
        incidents = RecordStore(folder / "incidents", quota, "incident")
    # Files may have many gigabytes, so recover them in a thread while the station
    # starts.
    threading.Thread(
        target=recover_all,
        args=((store, *([incidents] if incidents else [])), station, warn),
        name="recovery",
        daemon=True,
    ).start()
    return Recorder(station, store, incidents, texts=describe(station, config))


def recover_all(
    stores: Iterable[RecordStore], station: Station, warn: Callable[[str], None]
) -> None:
    """Recover the recordings of killed stations, beside a running control loop.

    Args:
        stores: The folders.
        station: The station, whose control thread has the right of way.
        warn: Called with a line about each recording, and about each skipped file.
    """
    for store in stores:
        for skipped in store.skipped():
            warn(f"A file of {store.folder} is skipped: {skipped}.")
        store.recover(
            station.loop.cycle_yield.wait_if_cycle_is_due,
            lambda info: warn(
                f"Recording {info.identifier} is {info.state}: {info.error}"
            ),
        )


def make_ports(
    app: "FastAPI", station: Station, config: StationConfig, policy: HostPolicy
) -> "list[ToolPort[Any]]":
    """Return the servers for Foxglove and rosbridge that are configured.

    Args:
        app: The application of the API; its tokens and lease apply to these servers,
            too.
        station: The station.
        config: Its configuration.
        policy: Hosts and origins that the API allows.
    """
    if not (config.foxglove.enabled or config.rosbridge.enabled):
        return []
    texts = describe(station, config)
    description = texts.get("/robot_description", "")
    # A mock may have no description, or one that is not a URDF.
    urdf = parse_urdf(description) if description.lstrip().startswith("<") else None

    # Imported here, because most stations do not need it.
    from station.api.tool_port import Place

    def place(section: "ToolPortSection") -> Place:
        hosts = {*policy.hosts, *host_names(section.host)}
        pages = HostPolicy(hosts, {*policy.origins, *section.allowed_origins})
        return Place(section.host, section.port, pages, is_loopback(section.host))

    ports: list[ToolPort[Any]] = []
    if config.foxglove.enabled:
        from station.api.foxglove.foxglove_port import FoxglovePort
        from station.api.foxglove.live_channels import LiveChannels

        channels = LiveChannels(station, urdf, texts)
        ports.append(FoxglovePort(app, channels, place(config.foxglove)))
    if config.rosbridge.enabled:
        from station.api.rosbridge.rosbridge_port import RosbridgePort

        latched = {k: v for k, v in texts.items() if k == "/robot_description"}
        ports.append(RosbridgePort(app, urdf, latched, place(config.rosbridge)))
    return ports


def describe(station: Station, config: StationConfig) -> dict[str, str]:
    """Return the station's description for a recording, by topic."""
    # A file must not contain the secrets of the servers.
    secret = {"api", "ui", "watchdog", "records", "foxglove", "rosbridge"}
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
        return found  # the name is better than nothing
