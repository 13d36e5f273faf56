from station.core.numerics.joint_errors cimport JointErrors


cpdef bint sample_splines(double[::1] splines, double time, double[::1] states) noexcept


cdef class SplineGroup:
    cdef Py_ssize_t n
    cdef double[::1] states
    cdef double[::1] splines
    cdef JointErrors position_errors
    cdef JointErrors velocity_errors

    cpdef void load(self, Py_ssize_t k, double[::1] spline) noexcept
    cpdef long follow(self, double time, double factor, double rate) noexcept
    cpdef void compare(self) noexcept
