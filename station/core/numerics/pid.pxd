cdef long NO_ERROR, NO_RATE

cdef class PidGroup:
    cdef Py_ssize_t n
    cdef double[::1] errors, rates, integrals, last, p, i, d, i_max, i_min, antiwindup
    cdef double[::1] desired_rates, rate_gains
    cdef readonly double[::1] commands
    cdef bint feeds_forward
    cpdef long compute_commands(self, double period, bint rates_known) noexcept
