cimport cython
from station.core.hardware.limits.limited_joints cimport LimitedJoints

cdef class LimitedRun:
    cdef LimitedJoints joints
    cdef object enforce
    cdef Py_ssize_t first
    cdef Py_ssize_t last
    cdef object count

cdef class EnforcedLimits:
    cdef public list runs
    cdef public list singles
    @cython.locals(run=LimitedRun, joints=LimitedJoints, mask=long)
    cpdef enforce(self, double period)
