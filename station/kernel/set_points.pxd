from station.kernel.command_laws cimport CommandLaw
from station.kernel.joint_errors cimport JointErrors
from station.kernel.pid cimport PidGroup
from station.kernel.sample_columns cimport SampleColumns
from station.kernel.usual_update cimport UsualUpdate

cdef double _INF

cdef class SetPointNews:
    cdef object slot
    cdef public bint is_void
    cdef public double deadline
    cpdef bint is_possible(self) except -1

cdef class SetPointInForce:
    cdef readonly SetPointNews news
    cdef readonly object desired
    cdef readonly object desired_rates
    cdef public bint has_rates

cdef class SetPointPidLaw(CommandLaw):
    cdef SetPointInForce set_point
    cdef JointErrors errors
    cdef JointErrors rate_errors
    cdef PidGroup pids

cdef class SetPointUpdate(UsualUpdate):
    cdef SetPointInForce set_point
    cdef CommandLaw law
    cdef SampleColumns sampled
    cdef readonly double period
    cpdef follow(self, double time, double period)
