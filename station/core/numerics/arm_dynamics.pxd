from station.core.numerics.arm_chain cimport place_links
from station.memory.vectors cimport copy_into

cdef class ArmDynamics:
    cdef Py_ssize_t size
    cdef double[::1] chain, given, bodies, q, links, moments, screws, wrenches
    cdef bint is_weighed
    cdef readonly long changes
    cdef readonly long long version
    cpdef void move_links(self, double[::1] q) noexcept
    cpdef void weigh(self) noexcept
    cpdef void mass(self, double[::1] result) noexcept
    cpdef void gravity(self, double[::1] acceleration, double[::1] result) noexcept
    cpdef void coriolis(self, double[::1] dq, double[::1] result) noexcept
