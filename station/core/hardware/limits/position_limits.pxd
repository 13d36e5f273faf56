from station.core.hardware.limits.limited_joints cimport LimitedJoints, SoftLimitedJoints

cdef long _BIT
cdef double _POSITION, _VELOCITY, _SOFT_POSITION


cdef class PositionSaturation(LimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept


cdef class PositionSoftLimits(SoftLimitedJoints):
    cpdef long enforce(self, double period, Py_ssize_t first, Py_ssize_t last) noexcept
