"""Publish the state of the robot's joints at a fixed rate.

Source: ros_controllers@678b92a joint_state_controller/src/joint_state_controller.cpp.
"""

import logging
from collections.abc import Mapping

from typing_extensions import override

from station.core.control.controller import PUBLISH_RATE, Controller, JointStates
from station.core.declared_parameter import NameKind, declare_mappings, declare_strings
from station.core.errors import ParameterError
from station.core.hardware.interfaces import JointStateGroup, JointStateInterface
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer

_JOINTS = declare_strings(
    "joints",
    "the published joints, in this order",
    names=NameKind.JOINT,
    default_text="all of the robot",
)
_EXTRA_JOINTS = declare_mappings(
    "extra_joints",
    "list of `{name, position, velocity, effort}`: constant values for "
    "joints that the robot does not report",
    (),
)
_logger = logging.getLogger(__name__)


class JointStateController(Controller[JointStateInterface]):
    """Publishes joint states; commands nothing.

    Parameters: `publish_rate` [Hz], required; nothing is published when the rate is
    not positive; `joints`, the joints and their order, all joints by default;
    `extra_joints`, a list of `{name, position, velocity, effort}` with constant
    values for joints that the robot does not report.

    Attributes:
        joint_states: The last publication, a new object each time; None before the
            first. Any thread may read it.

    Source:
        JointStateController; differs: whole numbers are valid values of extra joints,
        and missed publications are not made up for in a burst.
    """

    own_parameters = (PUBLISH_RATE, _JOINTS, _EXTRA_JOINTS)

    @override
    def init(self, interface: JointStateInterface, params: Parameters) -> None:
        self.joint_states: JointStates | None = None
        self._timer = PublishTimer(PUBLISH_RATE.read_float(params))
        names = _JOINTS.read_str_list(params, interface.get_names())
        self._group = JointStateGroup([interface.get_handle(name) for name in names])
        extra = _read_extra_joints(params, names)
        self.joint_names = names + list(extra)
        self._extra_values = {
            key: [values[key] for values in extra.values()]
            for key in ("position", "velocity", "effort")
        }

    @override
    def starting(self, time: float) -> None:
        """Publish in the first cycle; a restart keeps the times of publication."""
        self._timer.start(time, at_once=True)

    @override
    def update(self, time: float, period: float) -> None:
        """Publish when a publication is due."""
        if self._timer.is_due(time):
            self.joint_states = JointStates(
                stamp=time,
                name=self.joint_names,
                position=self._group.get_positions() + self._extra_values["position"],
                velocity=self._group.get_velocities() + self._extra_values["velocity"],
                effort=self._group.get_efforts() + self._extra_values["effort"],
            )

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        states = self.joint_states
        return {} if states is None else {"joint_states": states._asdict()}


def _read_extra_joints(
    params: Parameters, known: list[str]
) -> dict[str, dict[str, float]]:
    """Return position, velocity and effort of the extra joints by name.

    An entry that cannot be used is ignored with a warning, as in the original, because
    configurations of existing robots contain such entries.
    """
    extra: dict[str, dict[str, float]] = {}
    entries = params.get(_EXTRA_JOINTS.name, [])
    if not isinstance(entries, list):
        _logger.warning(
            "Parameter '%s' is not a list and is ignored.",
            params.resolve(_EXTRA_JOINTS.name),
        )
        return extra
    for entry in entries:
        values = dict(entry) if isinstance(entry, dict) else {}
        name = values.pop("name", None)
        if not isinstance(name, str) or name in known or name in extra:
            _logger.warning(
                "The extra joint %r has no name of its own and is ignored.", entry
            )
            continue
        view = Parameters()
        view.set("", values)
        try:
            extra[name] = {
                key: view.get_float(key, 0.0)
                for key in ("position", "velocity", "effort")
            }
        except ParameterError as error:
            _logger.warning("The extra joint '%s' is ignored: %s", name, error)
    return extra
