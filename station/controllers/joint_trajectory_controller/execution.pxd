from station.controllers.set_point_controller cimport CommandLaw
from station.core.control.sample_columns cimport SampleColumns
from station.core.numerics.joint_errors cimport JointErrors
from station.core.trajectory.ros_time cimport uptime_seconds
from station.core.trajectory.splines cimport sample_splines

cdef double _INF

cdef class SpeedScaling:
    cdef public double target, factor
    cdef readonly double ramp_time, rate
    cdef readonly object tunables
    cpdef double advance(self, double period)

cdef class JointTracking:
    cdef readonly object memory, desired, positions, velocities, accelerations, errors
    cdef readonly object rate_errors
    cdef readonly Py_ssize_t size
    cdef list _bounds
    cdef JointErrors _position, _velocity
    cdef double[::1] _states, _splines
    cpdef bint follow_splines(self, double time, double factor, double rate) noexcept
    cpdef void compare_states(self) noexcept
    cpdef bint exceeds_bounds(self) noexcept

cdef class GoalSupervision:
    cdef public object goal
    cdef object _joints
    cdef JointTracking _tracking
    cdef set _reached
    cdef double _start, _end
    cpdef note_progress(self, goal, double now)

cdef class TrajectoryExecution:
    cdef readonly SpeedScaling speed
    cdef readonly JointTracking tracking
    cdef readonly object requests, retired, times_from_start
    cdef readonly list trajectory
    cdef readonly tuple moment
    cdef readonly double sampled
    cdef object _names, _path_bounds, _decelerations
    cdef double _stop_duration, _passed, _load_time, _path_end, _begin
    cdef long long _uptime, _passed_ns
    cdef bint _rests
    cdef double[::1] _times
    cdef list _active
    cdef GoalSupervision _supervision
    cpdef advance(self, double time, double period)
    cdef _sample_states(self, double now)

cdef class TrajectoryUpdate:
    cdef TrajectoryExecution execution
    cdef object copies
    cdef CommandLaw law
    cdef readonly SampleColumns sampled
    cpdef command_joints(self, double time, double period)
