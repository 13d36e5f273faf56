cdef double _INF

cdef class SetPointPort:
    cdef public list elements
    cdef public object timeout
    cdef public object longest
    cdef public object clock
    cdef public list feed_forward
    cdef public object last
    cdef public bint is_void
    cdef public double deadline
    cdef public object generation
    cdef object _slot
    cdef object _in_force
    cdef object _newest
    cpdef bint has_changed(self) except -1
    cdef bint _has_expired(self) except -1

cdef class ActiveSetPoint:
    cdef readonly SetPointPort port
    cdef readonly object values
    cdef readonly object desired
    cdef readonly object desired_rates
    cdef public bint has_rates
    cdef object _action
    cdef object _subject
    cdef object _rest
    cpdef newest(self)
