from station.core.franka.joint_memory cimport JointMemory
from station.core.numerics.arm_chain cimport (
    place_links, torques_of, twist_of, zero_jacobian)
from station.core.numerics.command_rates cimport limited
from station.core.numerics.rigid_motion cimport compose, displace, twist_between
from station.core.numerics.arm_chain cimport WrenchEquation
from station.hw.franka.simulated.motion_check cimport MotionCheck
from station.memory.functions cimport square_root
from station.memory.vectors cimport copy_into

cdef double _UNIT_TOLERANCE, _STILL_STEP, _STILL_VELOCITY, _STILL_ACCELERATION
cdef double _LARGEST_STEP, _EXTENSION
cdef Py_ssize_t _TWIST_SIZE

cpdef bint is_transform(double[::1] pose) noexcept
cdef void bend(double[::1] q, double[::1] result) noexcept

cdef class EndEffectorState:
    cdef double[::1] chain, links, flange, jacobian, q, q_d, dq_d, ddq_d, tool, pose
    cdef double[::1] pose_d, pose_c, twist_d, twist_c, rate_c, elbow, elbow_d, elbow_c
    cdef double[::1] delbow_c, ddelbow_c

cdef class InverseKinematics:
    cdef double[::1] chain, q, tool, target, step, links, flange, pose, jacobian, error
    cdef double[::1] wrench
    cdef Py_ssize_t end
    cdef WrenchEquation equation
    cpdef void advance(self, double elbow) noexcept
    cdef void solve(self, double damping) noexcept

cdef class CartesianStep:
    cdef JointMemory memory
    cdef InverseKinematics kinematics
    cdef MotionCheck check
    cdef EndEffectorState state
    cdef double period
    cdef readonly double[::1] command, elbow_command, next_pose, next_twist, next_elbow
    cdef public Py_ssize_t size
    cdef public bint has_elbow, is_settled
    cpdef Py_ssize_t follow_command(self, bint is_first, bint may_settle)
    cpdef Py_ssize_t extrapolate(self)
    cdef bint repeats(self) noexcept
    cdef bint is_still(self) noexcept
    cpdef Py_ssize_t plan(self, bint is_first)
    cdef Py_ssize_t plan_elbow(self, bint is_first)
    cdef void rest_elbow(self) noexcept
    cpdef Py_ssize_t move_joints(self)
