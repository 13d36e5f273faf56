cpdef double multiplied(double value, double reduction, double offset) noexcept
cpdef double divided(double value, double reduction, double offset) noexcept

cdef class ReducedValues:
    cdef double[::1] source, target, reductions, offsets
    cdef long[::1] source_places, target_places
    cdef bint multiplies
    cdef readonly Py_ssize_t size
    cpdef carry(self)
