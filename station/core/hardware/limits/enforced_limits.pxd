cimport cython
from station.core.hardware.limits.limited_joints cimport LimitedJoints

cdef class LimitedRun:
    cdef LimitedJoints joints
    cdef object enforce, count
    cdef Py_ssize_t first, last

cdef class EnforcedLimits:
    cdef public list runs, singles
    @cython.locals(run=LimitedRun, joints=LimitedJoints, mask=long)
    cpdef enforce(self, double period)
