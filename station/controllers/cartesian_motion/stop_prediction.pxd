from station.memory.vectors cimport copy_into
from station.controllers.cartesian_motion.linear_kinematics cimport (
    LinearKinematics, length_of, limited_joint, moved, way_between)
from station.controllers.cartesian_motion.pose_motion cimport PoseMotion
from station.core.numerics.rigid_motion cimport twist_between

cdef double _NEAR

cdef class StopPrediction:
    cdef double[::1] pose, new, lower, upper, velocity, acceleration, q_d, rest, clear
    cdef double[::1] way, step
    cdef double elbow, room
    cdef public LinearKinematics present, resting
    cdef Py_ssize_t size
    cpdef bint passes(self, PoseMotion motion) noexcept
    cpdef bint has_left(self) noexcept
    cpdef bint leads_away(self, PoseMotion motion) noexcept
    cpdef long limited_joint(self) noexcept
    cpdef bint may_collide(self) noexcept
    cpdef bint are_slow(self, PoseMotion motion) noexcept
    cpdef long fastest_joint(
        self, LinearKinematics kinematics, PoseMotion motion) noexcept
    cpdef void accept(self) noexcept
    cpdef void note_clearance(self, double room) noexcept
