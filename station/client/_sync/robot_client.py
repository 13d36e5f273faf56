# Generated from _async/robot_client.py by tools/generate_client.py.
"""The client of one robot: its state, its services, and its simulation."""
# ruff: noqa: N802, N803 - NE_T_EE, F_x_center_load and so on are libfranka's names.

from collections.abc import Sequence

from pydantic import BaseModel, JsonValue, RootModel

from station.client._sync.connection import Connection
from station.client._sync.gripper_client import GripperClient
from station.client.errors import ApiError
from station.client.routes import Restart, segment
from station.wire import (
    ActiveFault,
    ArmLog,
    ArmModel,
    ArmRecord,
    ArmReport,
    CartesianImpedance,
    EndEffectorFrame,
    ExternalForce,
    Fault,
    Faults,
    ForceTorqueCollisionBehavior,
    FrameName,
    FrankaState,
    FullCollisionBehavior,
    GuidingRequest,
    JointImpedance,
    Load,
    Recovery,
    RecoveryRequest,
    ServiceInfo,
    Services,
    StiffnessFrame,
    UserStopRequest,
)


class _Answer(RootModel[JsonValue]):
    """The answer of a service, whatever it is."""


class RobotClient:
    """One arm of a station: `client.robot(arm_id)`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
        arm_id: The arm.

    Attributes:
        arm_id: The arm.
        gripper: Its gripper.
    """

    def __init__(self, connection: Connection, arm_id: str) -> None:
        self._connection = connection
        self._path = f"/robots/{segment(arm_id)}"
        self.arm_id = arm_id
        self.gripper = GripperClient(connection, arm_id)

    def state(self) -> FrankaState:
        """Return the whole state."""
        return self._connection.get(f"{self._path}/state", FrankaState)

    def model(self, frame: FrameName = "end_effector") -> ArmModel:
        """Return mass, Coriolis, gravity, and the pose and Jacobians of a frame."""
        query = {"frame": frame}
        return self._connection.get(f"{self._path}/model", ArmModel, query)

    def errors(self) -> ArmReport:
        """Return the arm's mode and errors, and what to do about them."""
        return self._connection.get(f"{self._path}/errors", ArmReport)

    def log(self) -> list[ArmRecord]:
        """Return the last cycles before the last error, oldest first."""
        return (self._connection.get(f"{self._path}/log", ArmLog)).records

    def recover(self, restart: Restart = "none") -> Recovery:
        """Clear the errors; with `previous` start the stopped controllers again."""
        return self._connection.send(
            "POST",
            f"{self._path}/error_recovery",
            Recovery,
            RecoveryRequest(restart=restart),
            patience=5.0,
        )

    def services(self) -> list[ServiceInfo]:
        """Return the robot's services; `call` calls each of them."""
        return (self._connection.get(f"{self._path}/services", Services)).services

    def call(self, name: str, /, **arguments: JsonValue) -> JsonValue:
        """Call a service of the robot and return its answer.

        The robot declares its services: this client needs no method for them.

        Args:
            name: The service.
            arguments: Its arguments by name.

        Raises:
            ApiError: The robot has no such service, or refuses.
        """
        services = {service.name: service for service in self.services()}
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
        answer = self._connection.send(service.method, path, _Answer, body)
        return answer.root

    def user_stop(self, *, pressed: bool) -> ArmReport:
        """Press or release the user stop; in simulation only."""
        return self._post("user_stop", UserStopRequest(pressed=pressed))

    def guiding(self, *, pressed: bool) -> ArmReport:
        """Press or release the guiding buttons; in simulation only."""
        return self._post("guiding", GuidingRequest(pressed=pressed))

    def connect(self) -> ArmReport:
        """Connect to the arm."""
        return self._post("connect")

    def disconnect(self) -> ArmReport:
        """Disconnect from the arm, which holds its pose."""
        return self._post("disconnect")

    def set_joint_impedance(self, joint_stiffness: Sequence[float]) -> ArmReport:
        """Set the internal joint impedance [Nm/rad], shape (7,)."""
        request = JointImpedance(joint_stiffness=list(joint_stiffness))
        return self._put("joint_impedance", request)

    def set_cartesian_impedance(
        self, cartesian_stiffness: Sequence[float]
    ) -> ArmReport:
        """Set the internal Cartesian impedance [N/m, Nm/rad], shape (6,)."""
        request = CartesianImpedance(cartesian_stiffness=list(cartesian_stiffness))
        return self._put("cartesian_impedance", request)

    def set_EE_frame(self, NE_T_EE: Sequence[float]) -> ArmReport:
        """Set the end effector frame, 16 numbers, column-major."""
        return self._put("ee_frame", EndEffectorFrame(NE_T_EE=list(NE_T_EE)))

    def set_K_frame(self, EE_T_K: Sequence[float]) -> ArmReport:
        """Set the stiffness frame, 16 numbers, column-major."""
        return self._put("k_frame", StiffnessFrame(EE_T_K=list(EE_T_K)))

    def set_load(self, load: Load) -> ArmReport:
        """Set the load that the hand holds."""
        return self._put("load", load)

    def set_force_torque_collision_behavior(
        self, behavior: ForceTorqueCollisionBehavior
    ) -> ArmReport:
        """Set the thresholds of contact and collision of every phase."""
        return self._put("force_torque_collision_behavior", behavior)

    def set_full_collision_behavior(self, behavior: FullCollisionBehavior) -> ArmReport:
        """Set the thresholds of contact and collision of both phases."""
        return self._put("full_collision_behavior", behavior)

    def apply_force(self, push: ExternalForce) -> ArmReport:
        """Push a link; in simulation only."""
        return self._post("external_force", push)

    def inject(self, fault: Fault) -> ArmReport:
        """Inject a fault; in simulation only."""
        return self._post("faults", fault)

    def faults(self) -> list[ActiveFault]:
        """Return the faults that are active; in simulation only."""
        return (self._connection.get(f"{self._path}/faults", Faults)).faults

    def clear_faults(self) -> list[ActiveFault]:
        """End all faults and all pushes; in simulation only."""
        path = f"{self._path}/faults"
        return (self._connection.send("DELETE", path, Faults)).faults

    def _put(self, what: str, request: BaseModel) -> ArmReport:
        path = f"{self._path}/{what}"
        return self._connection.send("PUT", path, ArmReport, request)

    def _post(self, what: str, request: BaseModel | None = None) -> ArmReport:
        path = f"{self._path}/{what}"
        return self._connection.send("POST", path, ArmReport, request)
