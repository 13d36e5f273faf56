from station.core.control.sample_columns cimport SampleColumns
from station.core.numerics.joint_errors cimport JointErrors
from station.core.numerics.pid cimport PidGroup
from station.core.ports.set_point cimport ActiveSetPoint
from station.memory.vectors cimport copy_into

cdef class CommandLaw:
    cpdef compute_commands(self, double period)

cdef class DirectLaw(CommandLaw):
    cdef double[::1] desired, commands
    cdef Py_ssize_t size
    cdef JointErrors errors

cdef class PidLaw(CommandLaw):
    cdef ActiveSetPoint set_point
    cdef JointErrors errors, rate_errors
    cdef PidGroup pids

cdef class SetPointUpdate:
    cdef ActiveSetPoint set_point
    cdef object copies
    cdef CommandLaw law
    cdef SampleColumns sampled
    cdef readonly double period
    cpdef command_joints(self, double time, double period)
