cdef double _INF

cdef class SetPointPort:
    cdef public list elements, feed_forward
    cdef public object timeout, longest, clock, last, generation
    cdef public bint is_void
    cdef public double deadline
    cdef object _slot, _in_force, _newest
    cpdef bint has_changed(self) except -1
    cdef bint _has_expired(self) except -1

cdef class ActiveSetPoint:
    cdef readonly SetPointPort port
    cdef readonly object values, desired, desired_rates
    cdef public bint has_rates
    cdef object _action, _subject, _rest
    cpdef newest(self)
