cimport cython
from station.kernel.joint_limits cimport LimitedJoints

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
