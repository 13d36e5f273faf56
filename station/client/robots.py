"""The clients of an arm, of its gripper, and of the simulation."""
# ruff: noqa: N802, N803 - NE_T_EE, F_x_center_load and so on are libfranka's names.

import time
from collections.abc import Mapping, Sequence
from typing import Literal, TypeAlias

from pydantic import BaseModel, JsonValue, RootModel

from station import wire
from station.client.connection import AsyncConnection, ClientPart, segment
from station.client.errors import ApiError, MotionError

Restart: TypeAlias = Literal["none", "previous"] | list[str]


class _Answer(RootModel[JsonValue]):
    """The answer of a service, which may have any type."""


class AsyncRobotClient(ClientPart):
    """One arm of a station: `client.robot(arm_id)`.

    Every method raises the errors of the station client's own methods.

    Args:
        connection: The connection to the station.
        arm_id: The arm.

    Attributes:
        arm_id: The arm.
        gripper: Its gripper.
    """

    def __init__(self, connection: AsyncConnection, arm_id: str) -> None:
        super().__init__(connection)
        self._path = f"/robots/{segment(arm_id)}"
        self.arm_id = arm_id
        self.gripper = AsyncGripperClient(connection, arm_id)

    async def state(self) -> wire.FrankaState:
        """Return the whole state."""
        return await self._get(f"{self._path}/state", wire.FrankaState)

    async def model(self, frame: wire.FrameName = "end_effector") -> wire.ArmModel:
        """Return mass, Coriolis, gravity, and the pose and Jacobians of a frame."""
        query = {"frame": frame}
        return await self._get(f"{self._path}/model", wire.ArmModel, query)

    async def errors(self) -> wire.ArmReport:
        """Return the arm's mode, errors and remedy."""
        return await self._get(f"{self._path}/errors", wire.ArmReport)

    async def log(self) -> list[wire.ArmRecord]:
        """Return the last cycles before the last error, oldest first."""
        return (await self._get(f"{self._path}/log", wire.ArmLog)).records

    async def recover(self, restart: Restart = "none") -> wire.Recovery:
        """Clear the errors; with `previous` start the stopped controllers again.

        Args:
            restart: `previous`, or the names of the controllers to start.
        """
        return await self._send(
            "POST",
            f"{self._path}/error_recovery",
            wire.Recovery,
            wire.RecoveryRequest(restart=restart),
            patience=5.0,
        )

    async def services(self) -> list[wire.ServiceInfo]:
        """Return the robot's services, each of which `call` can call."""
        return (await self._get(f"{self._path}/services", wire.Services)).services

    async def call(self, name: str, /, **arguments: JsonValue) -> JsonValue:
        """Call a service of the robot and return its answer.

        The robot declares its services, so this client needs no methods for them.

        Args:
            name: The service.
            arguments: Its arguments by name.

        Raises:
            ApiError: The robot has no such service, or refuses.
        """
        services = {service.name: service for service in await self.services()}
        service = services.get(name)
        if service is None:
            raise ApiError(
                f"Robot '{self.arm_id}' has no service '{name}'.",
                status=404,
                code="service_not_found",
                remedy=f"Its services are: {', '.join(services) or 'none'}.",
            )
        path = f"{self._path}/{service.path}"
        body = arguments if arguments or service.parameters else None
        return (await self._send(service.method, path, _Answer, body)).root

    async def user_stop(self, *, pressed: bool) -> wire.ArmReport:
        """Press or release the user stop; in simulation only."""
        return await self._post("user_stop", wire.UserStopRequest(pressed=pressed))

    async def guiding(self, *, pressed: bool) -> wire.ArmReport:
        """Press or release the guiding buttons; in simulation only."""
        return await self._post("guiding", wire.GuidingRequest(pressed=pressed))

    async def connect(self) -> wire.ArmReport:
        """Connect to the arm."""
        return await self._post("connect")

    async def disconnect(self) -> wire.ArmReport:
        """Disconnect from the arm, which holds its pose."""
        return await self._post("disconnect")

    async def set_joint_impedance(
        self, joint_stiffness: Sequence[float]
    ) -> wire.ArmReport:
        """Set the internal joint impedance [Nm/rad], shape (7,)."""
        request = wire.JointImpedance(joint_stiffness=list(joint_stiffness))
        return await self._put("joint_impedance", request)

    async def set_cartesian_impedance(
        self, cartesian_stiffness: Sequence[float]
    ) -> wire.ArmReport:
        """Set the internal Cartesian impedance [N/m, Nm/rad], shape (6,)."""
        request = wire.CartesianImpedance(cartesian_stiffness=list(cartesian_stiffness))
        return await self._put("cartesian_impedance", request)

    async def set_EE_frame(self, NE_T_EE: Sequence[float]) -> wire.ArmReport:
        """Set the end effector frame, 16 numbers, column-major."""
        return await self._put("ee_frame", wire.EndEffectorFrame(NE_T_EE=list(NE_T_EE)))

    async def set_K_frame(self, EE_T_K: Sequence[float]) -> wire.ArmReport:
        """Set the stiffness frame, 16 numbers, column-major."""
        return await self._put("k_frame", wire.StiffnessFrame(EE_T_K=list(EE_T_K)))

    async def set_load(self, load: wire.Load) -> wire.ArmReport:
        """Set the load that the hand holds."""
        return await self._put("load", load)

    async def set_force_torque_collision_behavior(
        self, behavior: wire.ForceTorqueCollisionBehavior
    ) -> wire.ArmReport:
        """Set the thresholds of contact and collision of every phase."""
        return await self._put("force_torque_collision_behavior", behavior)

    async def set_full_collision_behavior(
        self, behavior: wire.FullCollisionBehavior
    ) -> wire.ArmReport:
        """Set the thresholds of contact and collision of both phases."""
        return await self._put("full_collision_behavior", behavior)

    async def apply_force(self, push: wire.ExternalForce) -> wire.ArmReport:
        """Push a link; in simulation only."""
        return await self._post("external_force", push)

    async def inject(self, fault: wire.Fault) -> wire.ArmReport:
        """Inject a fault; in simulation only."""
        return await self._post("faults", fault)

    async def faults(self) -> list[wire.ActiveFault]:
        """Return the faults that are active; in simulation only."""
        return (await self._get(f"{self._path}/faults", wire.Faults)).faults

    async def clear_faults(self) -> list[wire.ActiveFault]:
        """End all faults and all pushes; in simulation only."""
        return (await self._send("DELETE", f"{self._path}/faults", wire.Faults)).faults

    async def _put(self, what: str, request: BaseModel) -> wire.ArmReport:
        return await self._send("PUT", f"{self._path}/{what}", wire.ArmReport, request)

    async def _post(
        self, what: str, request: BaseModel | None = None
    ) -> wire.ArmReport:
        return await self._send("POST", f"{self._path}/{what}", wire.ArmReport, request)


POLL = 0.05
"""Time between two requests for the state of a moving gripper [s]."""


class AsyncGripperClient(ClientPart):
    """The gripper of an arm: `client.robot(arm_id).gripper`.

    Homing, move and grasp begin and return at once; `state` has their progress. `open`
    and `close` wait until the fingers have arrived. Every method raises the errors of
    the station client's own methods.

    Args:
        connection: The connection to the station.
        arm_id: The arm.
    """

    def __init__(self, connection: AsyncConnection, arm_id: str) -> None:
        super().__init__(connection)
        self._path = f"/robots/{segment(arm_id)}/gripper"
        self.arm_id = arm_id

    async def state(self) -> wire.Gripper:
        """Return the state, with the active command and the last ended one."""
        return await self._get(self._path, wire.Gripper)

    async def open(
        self, width: float | None = None, *, speed: float = 0.1, timeout: float = 10.0
    ) -> wire.Gripper:
        """Open, or close without force, to a width and wait until it is reached.

        Args:
            width: Distance of the fingers [m]; None for the largest one.
            speed: Rate of the width, at most 0.4 [m/s].
            timeout: Longest wait [s].

        Raises:
            MotionError: The width was not reached; the message has the reason.
        """
        if width is None:
            width = (await self.state()).max_width
        request = wire.GripperMoveRequest(width=width, speed=speed)
        return await self._finish(await self.move(request), timeout)

    async def close(
        self, force: float = 20.0, *, speed: float = 0.1, timeout: float = 10.0
    ) -> wire.Gripper:
        """Close until the fingers touch an object or each other, and press.

        Args:
            force: Force of each finger, 0.1 to 140 [N].
            speed: How fast the width changes, at most 0.4 [m/s].
            timeout: Longest wait [s].

        Returns:
            The state; its `width` is that of the object, or 0 without an object.

        Raises:
            MotionError: The fingers did not close; the message has the reason.
        """
        # The inner tolerance accepts closed fingers whose width is slightly below zero.
        whatever = wire.GraspEpsilon(inner=0.005, outer=(await self.state()).max_width)
        request = wire.GripperGraspRequest(
            width=0.0, force=force, speed=speed, epsilon=whatever
        )
        return await self._finish(await self.grasp(request), timeout)

    async def homing(self) -> wire.Gripper:
        """Begin to close and to open the gripper completely."""
        return await self._send("POST", f"{self._path}/homing", wire.Gripper)

    async def move(self, request: wire.GripperMoveRequest) -> wire.Gripper:
        """Begin to open or close the gripper to a width."""
        return await self._send("POST", f"{self._path}/move", wire.Gripper, request)

    async def grasp(self, request: wire.GripperGraspRequest) -> wire.Gripper:
        """Begin to grasp an object."""
        return await self._send("POST", f"{self._path}/grasp", wire.Gripper, request)

    async def stop(self) -> wire.Gripper:
        """Hold the fingers still without force; a grasped object can fall."""
        return await self._send("POST", f"{self._path}/stop", wire.Gripper)

    async def _finish(self, begun: wire.Gripper, timeout: float) -> wire.Gripper:
        """Wait until the begun command has succeeded.

        Raises:
            MotionError: The gripper's command did not succeed.
        """
        command, state = begun.command, begun
        deadline = time.monotonic() + timeout
        while command and state.command and state.command.id == command.id:
            if time.monotonic() > deadline:
                raise MotionError(f"The gripper needed more than {timeout} s.")
            await self._connection.sleep(POLL)
            state = await self.state()
        last = state.last
        if last is None or last.status != "succeeded":
            raise MotionError(
                f"The gripper did not succeed: {last.message if last else 'no answer'}"
            )
        return state


class AsyncSimulationClient(ClientPart):
    """The simulation of a station: `client.simulation`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/simulation"

    async def state(self) -> wire.Simulation:
        """Return the state of simulated time: paused or not, and its speed."""
        return await self._get(self._path, wire.Simulation)

    async def bases(self) -> list[wire.MovingBase]:
        """Return the poses of the root links of robots with a moving base."""
        return (await self._get("/scene", wire.Scene)).bases

    async def contacts(self) -> list[wire.Contact]:
        """Return the contacts of the world with their forces."""
        return (await self._get("/scene", wire.Scene)).contacts

    async def pause(self) -> wire.Simulation:
        """Pause simulated time; stops and switches still work."""
        return await self._change(wire.SimulationPatch(paused=True))

    async def resume(self) -> wire.Simulation:
        """Resume simulated time."""
        return await self._change(wire.SimulationPatch(paused=False))

    async def set_real_time_factor(self, factor: float) -> wire.Simulation:
        """Change the speed of simulated time.

        Args:
            factor: Station time over wall time, more than 0, at most 100.
        """
        return await self._change(wire.SimulationPatch(real_time_factor=factor))

    async def _change(self, patch: wire.SimulationPatch) -> wire.Simulation:
        return await self._send("PATCH", self._path, wire.Simulation, patch)

    async def step(self, n: int = 1) -> wire.Simulation:
        """Run some cycles while paused; return when they are done.

        Args:
            n: Number of cycles, 1 to 10000.
        """
        path, request = f"{self._path}/step", wire.StepRequest(n=n)
        return await self._send(
            "POST", path, wire.Simulation, request, patience=0.1 * n
        )

    async def reset(
        self,
        joint_positions: Mapping[str, float] | None = None,
        keyframe: str | None = None,
    ) -> wire.Simulation:
        """Put the world back to its start; earlier set-points and goals are void.

        Args:
            joint_positions: Joint name to position [rad or m]; the other joints go to
                the keyframe, or to their initial positions.
            keyframe: Name of a pose to begin at; `get` lists the names.
        """
        request = wire.ResetRequest(joint_positions=dict(joint_positions or {}))
        if keyframe is not None:
            request = request.model_copy(update={"keyframe": keyframe})
        return await self._send("POST", f"{self._path}/reset", wire.Simulation, request)
