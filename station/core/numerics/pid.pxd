cdef long NO_ERROR, NO_RATE

cdef class PidGroup:
    cdef Py_ssize_t n
    cdef double[::1] errors
    cdef double[::1] rates
    cdef readonly double[::1] commands
    cdef double[::1] integrals
    cdef double[::1] last
    cdef double[::1] p
    cdef double[::1] i
    cdef double[::1] d
    cdef double[::1] i_max
    cdef double[::1] i_min
    cdef double[::1] antiwindup
    cdef bint feeds_forward
    cdef double[::1] desired_rates
    cdef double[::1] rate_gains

    cpdef set_gains(self, Py_ssize_t k, gains)
    cpdef void reset(self) noexcept
    cpdef void reset_to(self, Py_ssize_t k, double rate, double integral) noexcept
    cpdef void set_integral(self, Py_ssize_t k, double integral) noexcept
    cpdef double integral(self, Py_ssize_t k) noexcept
    cpdef long compute_commands(self, double period, bint rates_known) noexcept
