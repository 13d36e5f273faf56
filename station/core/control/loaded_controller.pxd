from station.core.control.sample_columns cimport SampleColumns
from station.core.numerics.durations cimport Durations

cdef class LoadedController:
    cdef readonly object controller
    cdef readonly object info
    cdef readonly object commands
    cdef readonly list blocks
    cdef SampleColumns sampled
    cdef Py_ssize_t place
    cdef readonly tuple fallback
    cdef readonly bint may_jump
    cdef tuple notes
    cdef public object fault
    cdef public object traceback
    cdef public bint is_unreleased
    cdef public bint fresh
    cdef object last_set_point
    cdef object last_goal
    cdef readonly object ownership
    cdef readonly Durations durations
    cdef public long long overruns
    cdef long long overruns_before
    cdef public double last_overrun
    cdef public long long late_updates
    cdef public double stalled_at
