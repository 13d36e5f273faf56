cdef double _NEVER

cdef class PublishTimer:
    cdef double interval, last
    cpdef bint is_due(self, double time) noexcept
