"""The station's services under the names and types of ros_control and franka_ros."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

from station.api.rosbridge.ros_types import RosTypeError, facts_of, type_named
from station.api.rosbridge.topics import (
    StationTopics,
    arms_of,
    loaded_controllers,
    seconds_of,
)
from station.api.routes.robots import collision_thresholds
from station.api.service_routes import call_service
from station.api.tool_port import ToolClient
from station.core.control.controller import ControllerBase
from station.core.control.switching import Strictness, SwitchRequest
from station.core.facade.station import Station
from station.core.franka import FrankaServices
from station.core.franka.arms import Arms
from station.core.hardware.services import ServiceKind
from station.records.cdr import Values

_GROUP = {"name": "Default", "state": True, "id": 0, "parent": 0}
_TRIGGER = "std_srvs/Trigger"
_THRESHOLDS = (
    "set_force_torque_collision_behavior",
    "set_full_collision_behavior",
)
Call = Callable[[ToolClient, Values], Mapping[str, object] | None]


@dataclass(frozen=True, slots=True)
class RosService:
    """A service.

    Attributes:
        name: Its name.
        type: Its type.
        call: Function that carries a request out and may block, so call it in a worker
            thread. It returns the response without the fields that tell the success.
        changes: Whether it changes the station, so that it needs an operator whom the
            lease allows.
        blocks: Whether `call` may block, so that it needs a thread.
        is_free: Function that returns whether a given request leaves the station
            unchanged.
    """

    name: str
    type: str
    call: Call
    changes: bool = False
    blocks: bool = True
    is_free: Callable[[ToolClient, Values], bool] = lambda _, __: False


class StationServices:
    """Provides the services of a station.

    Args:
        station: The station.
        topics: Topics of the station, whose clock the services use.
    """

    def __init__(self, station: Station, topics: StationTopics) -> None:
        self._station = station
        self._topics = topics

    def all(self) -> Iterator[RosService]:
        """Yield the present services, besides those of rosapi."""
        yield from self._of_manager()
        yield RosService("/stop", _TRIGGER, self._stop, blocks=False)
        for name, arm in (("release", False), ("arm", True)):
            call: Call = partial(self._release, arm)
            yield RosService(f"/stop/{name}", _TRIGGER, call, changes=True)
        for arm_id, space in arms_of(self._station):
            for name in _THRESHOLDS:
                kind = type_named("franka_msgs", name)
                call = partial(self._set_thresholds, arm_id)
                yield RosService(f"{space}/{name}", kind, call, changes=True)
            for name, service in FrankaServices.services().items():
                if service.kind is not ServiceKind.QUERY:
                    own = type_named("franka_msgs", name)
                    kind = own if service.parameters else _TRIGGER
                    call = partial(self._call_arm, arm_id, name)
                    yield RosService(f"{space}/{name}", kind, call, changes=True)
        for name, _, controller in loaded_controllers(self._station):
            yield from self._of_controller(name, controller)

    def _of_manager(self) -> Iterator[RosService]:
        for name, call, changes in (
            ("list_controllers", self._list, False),
            ("list_controller_types", self._types, False),
            ("load_controller", self._load, True),
            ("unload_controller", self._unload, True),
            ("switch_controller", self._switch, True),
            ("reload_controller_libraries", self._reload, True),
        ):
            kind = type_named("controller_manager_msgs", name)
            yield RosService(f"/controller_manager/{name}", kind, call, changes)

    def _of_controller(
        self, name: str, controller: ControllerBase
    ) -> Iterator[RosService]:
        if controller.trajectories is not None:
            yield RosService(
                f"/{name}/query_state",
                "control_msgs/QueryTrajectoryState",
                partial(self._query_state, name),
            )
        # ros_control has a server for the gains of each joint; add one for all gains,
        # too.
        joints = {key.rpartition("/")[0] for key in controller.tunables.values} - {""}
        form = "/gains/{}" if controller.trajectories is not None else "/{}/pid"
        places = {"": ""} | {f"{one}/": form.format(one) for one in sorted(joints)}
        for prefix, place in places.items() if controller.tunables.values else ():
            yield RosService(
                f"/{name}{place}/set_parameters",
                "dynamic_reconfigure/Reconfigure",
                partial(self._reconfigure, name, prefix),
                changes=True,
            )

    def _list(self, _: ToolClient, __: Values) -> Values:
        return {"controller": self._station.controllers()}

    def _types(self, _: ToolClient, __: Values) -> Values:
        found = self._station.manager.describe_controller_types()
        return {
            "types": [one.type for one in found],
            "base_classes": [one.base_class for one in found],
        }

    def _load(self, _: ToolClient, request: Values) -> None:
        self._station.load_controller(request["name"])

    def _unload(self, _: ToolClient, request: Values) -> None:
        self._station.unload_controller(request["name"])

    def _switch(self, client: ToolClient, request: Values) -> Values:
        result = self._station.switch_controllers(
            SwitchRequest(
                request["start_controllers"],
                request["stop_controllers"],
                Strictness.from_value(request["strictness"]),
                start_asap=request["start_asap"],
                timeout=request["timeout"],
            )
        )
        client.services.event_recorder.switch(client.websocket, result)
        return {"ok": result.ok}

    def _reload(self, _: ToolClient, request: Values) -> None:
        self._station.manager.reload_controller_libraries(
            force_kill=request["force_kill"]
        )

    def _stop(self, client: ToolClient, _: Values) -> Values:
        self._station.stop(
            f"A client of rosbridge ({client.access.name}) asked for it."
        )
        client.record("call /stop", "done", is_done=True)
        return {"message": "The station is stopped."}

    def _release(self, arm: bool, _: ToolClient, __: Values) -> Values:  # noqa: FBT001 - bound above
        state = self._station.release_stop(arm=arm)
        return {"message": f"The stop is {state.value}."}

    def _call_arm(self, arm_id: str, name: str, _: ToolClient, request: Values) -> None:
        call_service(self._station, arm_id, name, request)

    def _set_thresholds(self, arm_id: str, _: ToolClient, request: Values) -> None:
        behavior = collision_thresholds(request)
        Arms(self._station.robots).set_collision_behavior(arm_id, behavior)

    def _query_state(self, name: str, _: ToolClient, request: Values) -> Values:
        """Return the desired state at a time; at the present time for a time of zero.

        Raises:
            RosTypeError: The time is before the start of the station.
            StationError: The controller has no desired state for the time.
        """
        asked = seconds_of(request["time"])
        when = asked - self._topics.origin / 1e9
        if asked and when < 0.0:
            raise RosTypeError(
                f"'args/time' is {-when:.3f} s before the start of the station.",
                remedy="Ask for a time since then; 0 is the present time.",
            )
        state = self._station.motion.query_state(name, when if asked else None)
        names = self._station.manager.get_controller(name).joint_names
        return facts_of(state) | {"name": list(names)}

    def _reconfigure(
        self, name: str, prefix: str, _: ToolClient, request: Values
    ) -> Values:
        """Set gains; an empty request only reads them.

        Raises:
            RosTypeError: The request has texts or truth values, which gains are not.
            StationError: The station refuses the gains.
        """
        config = request["config"]
        for key in ("bools", "strs"):
            if config[key]:
                raise RosTypeError(
                    f"'args/config/{key}' names '{config[key][0]['name']}'; gains are "
                    "numbers, in doubles."
                )
        wanted = {
            f"{prefix}{one['name']}": float(one["value"])
            for one in (*config["doubles"], *config["ints"])
        }
        if wanted:
            self._station.tuning.set_gains(name, wanted)
        values = self._station.tuning.gains(name).values.items()
        doubles = [
            {"name": key.removeprefix(prefix), "value": value}
            for key, value in values
            if key.startswith(prefix)
        ]
        return {"config": {"doubles": doubles, "groups": [_GROUP]}}
