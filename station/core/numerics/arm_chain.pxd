cimport cython
from station.core.numerics.rigid_motion cimport compose, displace
from station.memory.functions cimport cosine, sine

cdef long _TREE_ROW

cpdef void place_links(double[::1] chain, double[::1] q, double[::1] links) noexcept
@cython.locals(parent=long)
cpdef void place_tree(double[::1] tree, double[::1] q, double[::1] links) noexcept
cpdef void zero_jacobian(
    double[::1] links, double[::1] pose, double[::1] result) noexcept
cpdef void turn_to_inner_axes(
    double[::1] pose, double[::1] vectors, double[::1] result) noexcept
cpdef void turn_to_outer_axes(
    double[::1] pose, double[::1] vectors, double[::1] result) noexcept
cpdef void twist_of(
    double[::1] jacobian, double[::1] rates, double[::1] result) noexcept
cpdef void torques_of(
    double[::1] jacobian, double[::1] wrench, double[::1] result) noexcept
cpdef void measure_accelerations(
    double[::1] links, double[::1] dq, double[::1] ddq, double[::1] gravity,
    double[::1] sensors, double[::1] result) noexcept
cpdef void least_rates(
    double[::1] jacobian, double[::1] twist, double[::1] matrix, double damping,
    double[::1] result) noexcept

cdef class JointChain:
    cdef readonly Py_ssize_t count
    cdef double[::1] origins, axes, turns, way, screws
    cdef long[::1] indices
    cdef readonly double[::1] pose, jacobian
    cpdef void place(self, double[::1] q) noexcept
    cpdef void differentiate(self) noexcept

cdef class WrenchEquation:
    cdef double l10, l20, l21, l30, l31, l32, l40, l41, l42, l43, l50, l51, l52, l53
    cdef double l54, d0, d1, d2, d3, d4, d5
    cpdef bint factorise(self, double[::1] jacobian, double damping) noexcept
    cpdef void solve(self, double[::1] b, double[::1] x) noexcept
