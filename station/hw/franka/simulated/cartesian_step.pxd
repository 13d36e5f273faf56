cimport cython
from station.memory.vectors cimport copy_into
from station.core.numerics.command_rates cimport limited
from station.core.franka.joint_memory cimport JointMemory
from station.core.numerics.rigid_motion cimport displace, twist_between
from station.hw.franka.simulated.end_effector_state cimport EndEffectorState
from station.hw.franka.simulated.inverse_kinematics cimport InverseKinematics
from station.hw.franka.simulated.motion_check cimport MotionCheck
from station.memory.functions cimport square_root

cdef double _UNIT_TOLERANCE, _STILL_STEP, _STILL_VELOCITY, _STILL_ACCELERATION
cdef Py_ssize_t _TWIST_SIZE

cpdef bint is_transform(double[::1] pose) noexcept

cdef class CartesianStep:
    cdef JointMemory memory
    cdef InverseKinematics kinematics
    cdef MotionCheck check
    cdef EndEffectorState state
    cdef double period
    cdef readonly double[::1] command, elbow_command, next_pose, next_twist, next_elbow
    cdef public Py_ssize_t size
    cdef public bint has_elbow, is_settled
    cpdef begin_motion(self)
    cpdef Py_ssize_t follow_command(self, bint is_first, bint may_settle)
    cpdef Py_ssize_t extrapolate(self)
    cdef bint repeats(self) noexcept
    cdef bint is_still(self) noexcept
    cpdef Py_ssize_t plan(self, bint is_first)
    @cython.locals(most=double)
    cdef Py_ssize_t check_start(self)
    cdef Py_ssize_t plan_elbow(self, bint is_first)
    cdef void rest_elbow(self) noexcept
    cpdef Py_ssize_t move_joints(self)
