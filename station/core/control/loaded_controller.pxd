from station.core.control.sample_columns cimport SampleColumns
from station.core.numerics.durations cimport Durations

cdef class LoadedController:
    cdef readonly object controller, info, commands, ownership
    cdef readonly list blocks
    cdef SampleColumns sampled
    cdef Py_ssize_t place
    cdef readonly tuple fallback
    cdef readonly bint may_jump
    cdef tuple notes
    cdef readonly tuple references, states, following, read
    cdef public object fault, traceback
    cdef public double update_rate
    cdef public object beside
    cdef readonly double loop_period
    cdef readonly long every
    cdef public long countdown
    cdef public double elapsed
    cdef public bint is_unreleased, fresh
    cdef object last_set_point, last_goal
    cdef readonly Durations durations
    cdef public long long overruns, late_updates
    cdef long long overruns_before
    cdef public double last_overrun, stalled_at
    cpdef double take_turn(self, double period)
