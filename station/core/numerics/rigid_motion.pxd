from station.memory.functions cimport arctangent, cosine, sine, square_root

cdef double SMALL

cpdef void compose(double[::1] first, double[::1] second, double[::1] result) noexcept
cpdef void rotation_between(
    double[::1] first, double[::1] second, double[::1] result) noexcept
cpdef void twist_between(
    double[::1] first, double[::1] second, double period, double[::1] result) noexcept
cpdef void displace(
    double[::1] pose, double[::1] way, double share, double[::1] result) noexcept
cpdef void numbers_of(double[::1] pose, double[::1] near, double[::1] result) noexcept
cpdef void quaternion_of(double[::1] pose, double[::1] result) noexcept
