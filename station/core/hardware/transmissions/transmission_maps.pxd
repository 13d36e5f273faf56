cpdef double multiplied(double value, double reduction, double offset) noexcept
cpdef double divided(double value, double reduction, double offset) noexcept

cdef class ReducedValues:
    cdef double[::1] source
    cdef double[::1] target
    cdef long[::1] source_places
    cdef long[::1] target_places
    cdef double[::1] reductions
    cdef double[::1] offsets
    cdef bint multiplies
    cdef readonly Py_ssize_t size
    cpdef carry(self)
