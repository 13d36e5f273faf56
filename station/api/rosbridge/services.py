"""The station's services under the names and types of ros_control and franka_ros."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial

from pydantic import ValidationError

from station import wire
from station.api.rosbridge.ros_types import RosTypeError
from station.api.rosbridge.topics import (
    StationTopics,
    arm_namespace,
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
from station.records.cdr import Values

_CONTROLLER_MANAGER = "/controller_manager"
_GROUP = {"name": "Default", "state": True, "id": 0, "parent": 0}
_SETTINGS = {
    "set_EE_frame": "SetEEFrame",
    "set_K_frame": "SetKFrame",
    "set_load": "SetLoad",
    "set_cartesian_impedance": "SetCartesianImpedance",
    "set_joint_impedance": "SetJointImpedance",
}
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
        is_quick: Whether `call` returns at once, so that it needs no thread.
        is_free: Function that returns whether a given request leaves the station
            unchanged; None if every request changes it.
    """

    name: str
    type: str
    call: Call
    changes: bool = False
    is_quick: bool = False
    is_free: Callable[[ToolClient, Values], bool] | None = None


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
        trigger = "std_srvs/Trigger"
        yield RosService("/stop", trigger, self._stop, is_quick=True)
        for name, arm in (("release", False), ("arm", True)):
            call = partial(self._release, arm)
            yield RosService(f"/stop/{name}", trigger, call, changes=True)
        for arm_id in self._station.robots.names(FrankaServices):
            yield from self._of_arm(arm_id)
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
            kind = "".join(word.capitalize() for word in name.split("_"))
            yield RosService(
                f"{_CONTROLLER_MANAGER}/{name}",
                f"controller_manager_msgs/{kind}",
                call,
                changes,
            )

    def _of_arm(self, arm_id: str) -> Iterator[RosService]:
        space = arm_namespace(self._station, arm_id)
        for name, kind in _SETTINGS.items():
            call = partial(self._call_arm, arm_id, name)
            yield RosService(
                f"{space}/{name}", f"franka_msgs/{kind}", call, changes=True
            )
        for name, kind, model in (
            ("force_torque", "ForceTorque", wire.ForceTorqueCollisionBehavior),
            ("full", "Full", wire.FullCollisionBehavior),
        ):
            yield RosService(
                f"{space}/set_{name}_collision_behavior",
                f"franka_msgs/Set{kind}CollisionBehavior",
                partial(self._set_collision_behavior, arm_id, model),
                changes=True,
            )
        for name in ("connect", "disconnect"):
            call = partial(self._call_arm, arm_id, name)
            yield RosService(f"{space}/{name}", "std_srvs/Trigger", call, changes=True)

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
        return {
            "controller": [
                {
                    "name": status.name,
                    "state": status.state.value,
                    "type": status.type,
                    "claimed_resources": [
                        {
                            "hardware_interface": one.hardware_interface,
                            "resources": list(one.resources),
                        }
                        for one in status.claimed_resources
                    ],
                }
                for status in self._station.controllers()
            ]
        }

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

    def _set_collision_behavior(
        self,
        arm_id: str,
        model: type[wire.ForceTorqueCollisionBehavior],
        _: ToolClient,
        request: Values,
    ) -> None:
        """Set the thresholds of contact and collision.

        Raises:
            RosTypeError: A threshold is not allowed.
        """
        try:
            wanted = model.model_validate(request)
        except ValidationError as error:
            first = error.errors()[0]
            where = "/".join(str(part) for part in first["loc"])
            raise RosTypeError(f"'args/{where}': {first['msg']}.") from error
        behavior = collision_thresholds(wanted)
        Arms(self._station.robots).set_collision_behavior(arm_id, behavior)

    def _query_state(self, name: str, _: ToolClient, request: Values) -> Values:
        asked = seconds_of(request["time"])
        when = asked - self._topics.origin / 1e9 if asked else None
        state = self._station.motion.query_state(name, when)
        return {
            "name": list(self._station.manager.get_controller(name).joint_names),
            "position": list(state.position),
            "velocity": list(state.velocity),
            "acceleration": list(state.acceleration),
        }

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
        empty: Values = {"bools": [], "ints": [], "strs": []}
        return {"config": {**empty, "doubles": doubles, "groups": [_GROUP]}}
