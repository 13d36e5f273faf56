cimport cython
from station.memory.functions cimport cosine, sine

cdef long _TREE_ROW

cpdef void place_links(double[::1] chain, double[::1] q, double[::1] links) noexcept
@cython.locals(
    r=long, k=long, p=long, i=long, axis=long, parent=long, x=double, y=double, z=double)
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
@cython.locals(size=long)
cpdef void least_rates(
    double[::1] jacobian, double[::1] twist, double[::1] matrix, double damping,
    double[::1] result) noexcept
