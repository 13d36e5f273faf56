cdef long _BIT
cdef double _POSITION, _VELOCITY, _ACCELERATION, _EFFORT, _SOFT_POSITION, _INFINITY


cdef double approach(double distance, double gain, double speed) noexcept


cdef class LimitedJoints:
    cdef double[::1] position, velocity, command, min_position, max_position
    cdef double[::1] max_velocity, max_acceleration, max_jerk, max_effort, soft_min
    cdef double[::1] soft_max, k_position, k_velocity, previous, velocity_before
    cdef double[::1] acceleration_before, asked, reason

    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept


cdef class SoftLimitedJoints(LimitedJoints):
    cdef double[::1] free_min, free_max


cdef class EffortSaturation(LimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept


cdef class EffortSoftLimits(SoftLimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept


cdef class VelocitySaturation(LimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept


cdef class VelocitySoftLimits(LimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept


cdef class PositionSaturation(LimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept


cdef class PositionSoftLimits(SoftLimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept
