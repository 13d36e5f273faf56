cimport cython
from station.controllers.set_point_controller cimport CommandLaw
from station.core.numerics.pid cimport PidGroup
from station.core.trajectory.ros_time cimport uptime_seconds
from station.core.control.sample_columns cimport SampleColumns
from station.core.trajectory.splines cimport SplineGroup
from station.core.control.usual_update cimport UsualUpdate

cdef double _INF

cdef class SpeedFactor:
    cdef public double target
    cdef readonly double ramp_time
    cdef public double factor
    cdef readonly double rate
    @cython.locals(before=double, step=double, difference=double)
    cpdef double advance(self, double period)

cdef class TrajectoryTime:
    cdef readonly SpeedFactor speed
    cdef readonly SplineGroup splines
    cdef readonly tuple moment
    cdef long long uptime
    cdef double passed
    cdef long long passed_ns
    cdef public double sampled
    cdef public double load_time
    cdef public double path_end
    cdef public double begin
    cdef public bint rests
    cdef readonly object times_from_start
    cdef double[::1] times
    cpdef load(self, double now)
    cpdef set_moment(self, double time, double period, long long uptime)
    @cython.locals(passed=double)
    cpdef double pass_time(self, double time, double period) except? -1.0
    @cython.locals(found=long)
    cpdef bint sample(self, double now) except -1

cdef class FeedForwardPidLaw(CommandLaw):
    cdef PidGroup pids
    cdef double[::1] rates
    cdef double[::1] gains
    cdef bint feeds_forward

cdef class TrajectoryUpdate(UsualUpdate):
    cdef TrajectoryTime execution
    cdef object requests
    cdef object supervision
    cdef CommandLaw law
    cdef SampleColumns sampled
