from station.memory.functions cimport square_root
from station.core.hardware.limits.limited_joints cimport LimitedJoints

cdef long _BIT
cdef double _POSITION, _VELOCITY, _ACCELERATION, _JERK, _INFINITY, _NO_REASON

cpdef double approach(double distance, double rate_limit, double period) noexcept

cpdef double stoppable(
    double distance, double velocity, double acceleration, double max_acceleration,
    double max_jerk, double period) noexcept

cdef class VelocityRateLimits(LimitedJoints):
    cdef bint has_positions
    cpdef double shape(
        self, Py_ssize_t i, double asked, double down, double up, double period
    ) noexcept
