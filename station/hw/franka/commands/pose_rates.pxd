from station.memory.functions cimport square_root
from station.core.numerics.rigid_motion cimport displace, rotation_between, twist_between

cdef double _TINY

cpdef void limit_vector(
    double[::1] vector,
    Py_ssize_t start,
    double[::1] last_velocity,
    double[::1] last_acceleration,
    double[::1] bounds,
    double share,
    double period,
) noexcept

cdef class PoseRates:
    cdef double[::1] pose
    cdef double[::1] twist
    cdef double[::1] acceleration
    cdef double[::1] translation
    cdef double[::1] rotation
    cdef double pose_share
    cdef double period
    cdef public double gain
    cdef public bint is_limiting
    cdef readonly double[::1] sent_pose
    cdef readonly double[::1] sent_twist
    cdef double[::1] way

    cpdef void filter_pose(self, double[::1] pose, bint passes) noexcept
    cpdef void filter_twist(self, double[::1] twist) noexcept
    cpdef void limit(self, double[::1] twist, double rotation_share) noexcept
