from station.core.control.sample_columns cimport SampleColumns
from station.core.numerics.durations cimport DurationRing

cdef class UpdateTimes(DurationRing):
    cdef public double last_overrun, stalled_at
    cdef public long long overruns, late_updates
    cdef readonly long long overruns_before

cdef class LoadedController:
    cdef readonly object controller, info, commands, ownership
    cdef readonly list blocks
    cdef readonly SampleColumns sampled
    cdef readonly tuple fallback, references, states, following, read
    cdef readonly bint may_jump
    cdef tuple notes
    cdef public object fault, traceback, beside
    cdef public double update_rate, elapsed
    cdef readonly double loop_period
    cdef readonly long every
    cdef public long countdown, place
    cdef public bint is_unreleased, fresh
    cdef object last_set_point, last_goal
    cdef readonly UpdateTimes times
    cpdef double count_cycle(self, double period)
