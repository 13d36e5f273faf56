cimport cython

cdef double _NEVER

cdef class PublishTimer:
    cdef double interval
    cdef double last
    cpdef void start(self, double time, bint at_once) noexcept
    @cython.locals(due=double)
    cpdef bint is_due(self, double time) noexcept
