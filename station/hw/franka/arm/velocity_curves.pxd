from station.memory.functions cimport square_root

cpdef double velocity_towards_end(
    double highest, double a, double b, double room) noexcept

cdef class VelocityCurves:
    cdef readonly Py_ssize_t size
    cdef double[::1] highest, a, b, upper, lower, margins
    cpdef void put(
        self, double[::1] q, double[::1] lowest, double[::1] highest) noexcept
