from station.memory.vectors cimport copy_into
from station.controllers.cartesian_motion.linear_kinematics cimport (
    LinearKinematics,
    length_of,
    limited_joint,
    moved,
    way_between,
)
from station.controllers.cartesian_motion.pose_motion cimport PoseMotion
from station.core.numerics.rigid_motion cimport twist_between

cdef double _NEAR

cdef class StopPrediction:
    cdef double[::1] pose
    cdef double[::1] new
    cdef double[::1] lower
    cdef double[::1] upper
    cdef double[::1] velocity
    cdef double[::1] acceleration
    cdef double[::1] q_d
    cdef double elbow
    cdef public LinearKinematics present
    cdef public LinearKinematics resting
    cdef double room
    cdef double[::1] rest
    cdef double[::1] clear
    cdef double[::1] way
    cdef double[::1] step
    cdef Py_ssize_t size

    cpdef start_at_rest(self, double[::1] q_d)
    cpdef bint passes(self, PoseMotion motion) noexcept
    cpdef bint has_left(self) noexcept
    cpdef bint leads_away(self, PoseMotion motion) noexcept
    cpdef long limited_joint(self) noexcept
    cpdef bint may_collide(self) noexcept
    cpdef bint are_slow(self, PoseMotion motion) noexcept
    cpdef long fastest_joint(self, LinearKinematics kinematics, PoseMotion motion) noexcept
    cpdef void accept(self) noexcept
    cpdef void note_clearance(self, double room) noexcept
