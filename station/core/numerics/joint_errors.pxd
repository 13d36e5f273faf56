cdef double _HALF_TURN
cdef double _TURN
cdef double _LIMIT_ROUNDING

cpdef double shortest_angular_distance(double start, double end) noexcept
cpdef double shortest_angular_distance_with_limits(
    double start, double end, double lower, double upper
) noexcept
cpdef Py_ssize_t first_excess(double[::1] errors, double[::1] bounds) noexcept


cdef class JointErrors:
    cdef Py_ssize_t n
    cdef double[::1] desired
    cdef double[::1] measured
    cdef double[::1] errors
    cdef double[::1] wrapping
    cdef double[::1] lower
    cdef double[::1] upper
    cdef double[::1] bounds

    cpdef void set_wrapping(
        self, Py_ssize_t k, double wrapping, double lower, double upper
    ) noexcept
    cpdef void set_bound(self, Py_ssize_t k, double bound) noexcept
    cpdef void compare(self) noexcept
    cpdef bint exceeds(self) noexcept
