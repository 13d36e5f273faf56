cimport cython

cdef double _NEVER

cdef class PublishTimer:
    cdef double interval, last
    @cython.locals(due=double)
    cpdef bint is_due(self, double time) noexcept
