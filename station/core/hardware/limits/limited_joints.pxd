cimport cython

cdef long _BIT
cdef double _POSITION, _VELOCITY, _ACCELERATION, _EFFORT, _SOFT_POSITION, _INFINITY

cdef double approach(double distance, double gain, double speed) noexcept

cdef class LimitedJoints:
    cdef double[::1] position, velocity, command, min_position, max_position
    cdef double[::1] max_velocity, max_acceleration, max_jerk, max_effort, soft_min
    cdef double[::1] soft_max, k_position, k_velocity, previous, velocity_before
    cdef double[::1] acceleration_before, asked, reason, free_min, free_max
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept

cdef class EffortSaturation(LimitedJoints):
    pass

cdef class EffortSoftLimits(LimitedJoints):
    pass

cdef class VelocitySoftLimits(LimitedJoints):
    cdef double[::1] before

cdef class PositionLimits(LimitedJoints):
    pass

cdef class LimitedRun:
    cdef LimitedJoints joints
    cdef object enforce, count
    cdef Py_ssize_t first, last

cdef class EnforcedLimits:
    cdef public list runs, singles
    @cython.locals(run=LimitedRun, mask=long)
    cpdef enforce(self, double period)
