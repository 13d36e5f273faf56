cdef class WrenchEquation:
    cdef double l10, l20, l21, l30, l31, l32, l40, l41, l42, l43, l50, l51, l52, l53
    cdef double l54, d0, d1, d2, d3, d4, d5
    cpdef bint factorise(self, double[::1] jacobian, double damping) noexcept
    cpdef void solve(self, double[::1] b, double[::1] x) noexcept
