from station.memory.vectors cimport copy_into
from station.core.numerics.joint_errors cimport JointErrors
from station.core.numerics.pid_group cimport PidGroup, add_feed_forward

cdef class CommandLaw:
    cpdef command(self, double period)

cdef class DirectLaw(CommandLaw):
    cdef double[::1] desired
    cdef double[::1] commands
    cdef Py_ssize_t size

cdef class ComparingLaw(DirectLaw):
    cdef JointErrors errors

cdef class PidLaw(CommandLaw):
    cdef PidGroup pids
    cdef double[::1] commands
    cdef double[::1] rates
    cdef double[::1] shares
    cdef bint feeds_forward
