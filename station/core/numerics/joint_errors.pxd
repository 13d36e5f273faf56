cdef double _HALF_TURN
cdef double _TURN
cdef double _LIMIT_ROUNDING

cpdef double shortest_angular_distance(double start, double end) noexcept
cpdef Py_ssize_t first_excess(double[::1] errors, double[::1] bounds) noexcept

cdef class JointErrors:
    cdef Py_ssize_t n
    cdef double[::1] desired, measured, errors, wrapping, lower, upper, bounds
    cpdef void compare(self) noexcept
    cpdef bint exceeds(self) noexcept
