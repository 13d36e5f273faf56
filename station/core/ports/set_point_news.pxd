cdef double _INF

cdef class SetPointNews:
    cdef object slot
    cdef public bint is_void
    cdef public double deadline
    cpdef bint is_possible(self) except -1
