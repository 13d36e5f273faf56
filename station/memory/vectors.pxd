cpdef void copy_into(
    double[::1] target, Py_ssize_t start, double[::1] source, Py_ssize_t size) noexcept
cpdef bint differ(double[::1] first, double[::1] second, Py_ssize_t size) noexcept
cpdef bint are_finite(double[::1] numbers, Py_ssize_t size) noexcept
cpdef bint any_of(double[::1] numbers, Py_ssize_t size) noexcept
cpdef bint are_within(double[::1] numbers, double[::1] shares, Py_ssize_t size) noexcept

cdef class FiniteCheck:
    cdef double[::1] memory
    cdef readonly Py_ssize_t size
    cpdef Py_ssize_t first_bad(self)
