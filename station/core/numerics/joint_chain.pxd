cimport cython
from station.core.numerics.arm_chain cimport turn_to_outer_axes
from station.core.numerics.rigid_motion cimport compose, displace

cdef class JointChain:
    cdef readonly Py_ssize_t count
    cdef double[::1] origins, axes, turns, indices, way, screws
    cdef readonly double[::1] pose, jacobian
    cpdef void place(self, double[::1] q) noexcept
    @cython.locals(column=Py_ssize_t)
    cpdef void differentiate(self) noexcept
