"""Chains of controllers that command references of others, and their order.

A preceding controller claims references that its following controllers export. It is
loaded after them, so chains have no circles.

Source: ros2_control@4.x controller_manager/src/controller_manager.cpp,
controller_sorting, check_following_controllers_for_activate,
check_preceding_controllers_for_deactivate; differs: see `chainable_controller.py`.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from station.core.control.chainable_controller import (
    ChainableController,
    ExportedStateHandle,
    ExportedStateInterface,
    ReferenceHandle,
    ReferenceInterface,
)
from station.core.control.loaded_controller import LoadedController
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.resource_manager import interface_type_name
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    ResourceConflict,
    RobotHW,
)
from station.reports import ChainedController, ControllerChains, ExportedValue

if TYPE_CHECKING:
    from station.core.hardware.interfaces.resource_manager import ResourceManager

_JOINT_INTERFACES = {
    "position": PositionJointInterface,
    "velocity": VelocityJointInterface,
    "effort": EffortJointInterface,
}
_BOTH = ("position", "velocity")
_QUANTITIES: Mapping[str, tuple[str, ...]] = {
    **{interface_type_name(kind): (name,) for name, kind in _JOINT_INTERFACES.items()},
    interface_type_name(PosVelJointInterface): _BOTH,
}
"""The quantities of a joint that a controller commands through an interface."""
REFERENCES = interface_type_name(ReferenceInterface)
"""The interface of claimed references, in messages and reports."""
_STATES = interface_type_name(ExportedStateInterface)


class ChainedRobotHW(RobotHW):
    """The robot with the exports of loaded controllers, for the next `init`.

    Args:
        hw: The robot.
        loaded: The loaded controllers.

    Attributes:
        owners: The controller that exports each reference or state, by full name.
    """

    def __init__(self, hw: RobotHW, loaded: Iterable[LoadedController]) -> None:
        super().__init__()
        self.owners: dict[str, LoadedController] = {}
        self._references = ReferenceInterface()
        self._states = ExportedStateInterface()
        self._joints = {kind: kind() for kind in _JOINT_INTERFACES.values()}
        self._both = PosVelJointInterface()
        joints = hw.get(JointStateInterface)
        states = {} if joints is None else {one.name: one for one in joints.handles()}
        for one in loaded:
            self._add(one, states)
        exported: list[ResourceManager[Any]] = [self._references, self._states]
        for interface in (*exported, *self._joints.values(), self._both):
            if interface.get_names():
                self.register_interface(interface)
        self.register_interface_manager(hw)

    def _add(self, one: LoadedController, joints: dict[str, JointStateHandle]) -> None:
        for state in one.states:
            name = f"{one.info.name}/{state.name}"
            self.owners[name] = one
            self._states.register_handle(ExportedStateHandle(name, state))
        by_name = {reference.name: reference for reference in one.references}
        for reference in one.references:
            name = f"{one.info.name}/{reference.name}"
            self.owners[name] = one
            self._references.register_handle(ReferenceHandle(name, reference))
            joint, _, quantity = reference.name.rpartition("/")
            kind, state_handle = _JOINT_INTERFACES.get(quantity), joints.get(joint)
            # A controller of joints may claim the reference as if it were the joint.
            if kind is not None and state_handle is not None:
                handle = JointStateHandle(
                    f"{one.info.name}/{joint}",
                    state_handle.position_storage,
                    state_handle.velocity_storage,
                    state_handle.effort_storage,
                    state_handle.index,
                )
                self._joints[kind].register_handle(
                    JointHandle(handle, reference.storage, reference.index)
                )
                second = by_name.get(f"{joint}/velocity")
                if quantity == "position" and second is not None:
                    self._both.register_handle(
                        PosVelJointHandle(
                            handle, reference.storage, second.storage, second.index
                        )
                    )

    def split_claims(
        self, claims: Iterable[InterfaceResources]
    ) -> tuple[tuple[InterfaceResources, ...], tuple[str, ...], tuple[str, ...]]:
        """Separate the claims of the robot's resources from those of references.

        Returns:
            Claims of the robot's resources; full names of the claimed references; full
            names of the exported states that are read. All are sorted.
        """
        robot: list[InterfaceResources] = []
        # A controller that does not declare these two interfaces may have claimed
        # through them, too.
        references = set(self._references.get_claims())
        states = set(self._states.get_claims())
        for claim in claims:
            if claim.hardware_interface == REFERENCES:
                references.update(claim.resources)
                continue
            if claim.hardware_interface == _STATES:
                states.update(claim.resources)
                continue
            quantities = _QUANTITIES.get(claim.hardware_interface, ())
            exported = {
                name
                for name in claim.resources
                if any(f"{name}/{each}" in self.owners for each in quantities)
            }
            references.update(f"{n}/{each}" for n in exported for each in quantities)
            own = tuple(name for name in claim.resources if name not in exported)
            robot.append(InterfaceResources(claim.hardware_interface, own))
        return tuple(robot), tuple(sorted(references)), tuple(sorted(states))

    def owners_of(self, names: Iterable[str]) -> tuple[LoadedController, ...]:
        """Return the controllers that export some names, each once."""
        return tuple(dict.fromkeys(self.owners[name] for name in names))


def claims_of_references(names: Sequence[str]) -> tuple[InterfaceResources, ...]:
    """Return a claim of these references; nothing if there are none."""
    return (InterfaceResources(REFERENCES, tuple(names)),) if names else ()


def find_conflicts(
    hw: RobotHW, controllers: Sequence[ControllerInfo]
) -> list[ResourceConflict]:
    """Return the conflicts of the robot, and references with two owners.

    Args:
        hw: The robot; it does not see the references.
        controllers: All controllers that would be running.
    """
    conflicts = list(hw.check_for_conflict(controllers))
    holders: dict[str, list[str]] = {}
    for info in controllers:
        for name in info.references:
            holders.setdefault(name, []).append(info.name)
    for name, owners in holders.items():
        if len(owners) > 1:
            named = " and ".join(f"'{owner}'" for owner in owners)
            conflicts.append(
                ResourceConflict(
                    name,
                    tuple((owner, REFERENCES) for owner in owners),
                    f"Reference '{name}' is claimed by {named}.",
                )
            )
    return conflicts


def chains_report(loaded: Sequence[LoadedController]) -> ControllerChains:
    """Return exports and following controllers of each controller. Any thread."""
    commanded = {one.info.name: one.info.references for one in loaded}
    read = {one.info.name: one.info.states for one in loaded}
    found = []
    for one in loaded:
        controller, name = one.controller, one.info.name
        found.append(
            ChainedController(
                name,
                controller.state.value,
                isinstance(controller, ChainableController)
                and controller.is_in_chained_mode,
                tuple(each.info.name for each in one.following),
                tuple(
                    _exported(f"{name}/{reference.name}", commanded)
                    for reference in one.references
                ),
                tuple(_exported(f"{name}/{state.name}", read) for state in one.states),
            )
        )
    return ControllerChains(tuple(found))


def _exported(name: str, used: Mapping[str, Sequence[str]]) -> ExportedValue:
    """Return an exported value, and who uses it of those that name what they use."""
    return ExportedValue(name, tuple(user for user in used if name in used[user]))


def depth_of(one: LoadedController) -> int:
    """Return the length of the longest chain below a controller; 0 for none.

    The chain are the controllers that it commands, or whose states it reads.
    """
    return max((1 + depth_of(each) for each in (*one.following, *one.read)), default=0)


def insert_in_order(
    loaded: tuple[LoadedController, ...], one: LoadedController
) -> tuple[LoadedController, ...]:
    """Return the list with `one` inserted before the controllers that it commands.

    No controller commands `one`, which has just been loaded, so the order of the others
    stays.
    """
    place = min((loaded.index(each) for each in one.following), default=len(loaded))
    return (*loaded[:place], one, *loaded[place:])
