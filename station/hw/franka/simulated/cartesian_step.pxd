from station.memory.vectors cimport copy_into
from station.hw.franka.simulated.command_check cimport CommandCheck
from station.core.franka.command_rates cimport limited
from station.memory.functions cimport square_root
from station.hw.franka.simulated.inverse_kinematics cimport InverseKinematics
from station.core.franka.joint_memory cimport JointMemory
from station.core.numerics.rigid_motion cimport displace, twist_between

cdef double UNIT_TOLERANCE, _STILL_STEP, _STILL_VELOCITY, _STILL_ACCELERATION

cpdef bint is_transform(double[::1] pose) noexcept

cdef class CartesianStep:
    cdef JointMemory memory
    cdef InverseKinematics kinematics
    cdef CommandCheck check
    cdef double[::1] pose
    cdef double[::1] twist
    cdef double[::1] acceleration
    cdef double[::1] elbow
    cdef double[::1] elbow_velocity
    cdef double[::1] elbow_acceleration
    cdef double[::1] translation
    cdef double[::1] rotation
    cdef double[::1] elbow_limits
    cdef double period
    cdef readonly double[::1] command
    cdef public Py_ssize_t size
    cdef public bint has_elbow
    cdef public bint is_settled
    cdef readonly double[::1] next_pose
    cdef readonly double[::1] next_twist
    cdef readonly double[::1] next_elbow
    cdef readonly double[::1] target

    cpdef bint follow(self)
    cpdef bint repeats(self) noexcept
    cpdef bint is_still(self) noexcept
    cpdef bint plan(self) noexcept
    cpdef void plan_twist(self, double[::1] twist) noexcept
    cpdef bint admits_twist(self) noexcept
    cpdef bint admits(self, Py_ssize_t start, double[::1] bounds) noexcept
    cpdef void rest_elbow(self) noexcept
    cpdef void extrapolate(self) noexcept
    cpdef void move_joints(self) noexcept
    cpdef void accept(self) noexcept
