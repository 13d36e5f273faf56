from station.core.numerics.arm_chain cimport (
    WrenchEquation, place_links, torques_of, zero_jacobian)
from station.memory.vectors cimport copy_into
from station.core.numerics.rigid_motion cimport compose, twist_between

cdef double _LARGEST_STEP

cdef class InverseKinematics:
    cdef double[::1] chain, q, tool, step, links, flange, pose, jacobian, error, wrench
    cdef readonly double[::1] target
    cdef Py_ssize_t end
    cdef WrenchEquation equation
    cpdef void advance(self, double elbow) noexcept
    cpdef void solve(self, double damping) noexcept
