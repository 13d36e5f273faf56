cdef double _NONE, _LEGACY, _CLAMPED, _BACK, _CONDITIONAL

cdef double _bounded(double value, double low, double high) noexcept

cdef class SaturatingPids:
    cdef readonly Py_ssize_t size
    cdef readonly double[::1] errors, rates, forward, commands, parts, last
    cdef readonly double[::1] p, i, d, f, part_max, part_min, maximum, minimum
    cdef readonly double[::1] tracking, deadband, strategies
    cpdef void compute_commands(self, double period, bint rates_known) noexcept
    cdef double saturated(self, Py_ssize_t k, double period, double rate) noexcept
