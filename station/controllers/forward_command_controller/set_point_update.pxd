from station.controllers.forward_command_controller.command_laws cimport CommandLaw
from station.core.numerics.joint_errors cimport JointErrors
from station.core.numerics.pid_group cimport PidGroup
from station.core.control.sample_columns cimport SampleColumns
from station.core.control.usual_update cimport UsualUpdate
from station.core.ports.set_point_news cimport SetPointNews

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
