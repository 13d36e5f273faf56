from station.core.numerics.arm_chain cimport place_links, torques_of, zero_jacobian
from station.memory.vectors cimport copy_into
from station.core.numerics.rigid_motion cimport compose, twist_between
from station.core.numerics.wrench_equation cimport WrenchEquation

cdef double _LARGEST_STEP

cdef class InverseKinematics:
    cdef double[::1] chain
    cdef double[::1] q
    cdef double[::1] tool
    cdef readonly double[::1] target
    cdef double[::1] step
    cdef double[::1] links
    cdef Py_ssize_t end
    cdef double[::1] flange
    cdef double[::1] pose
    cdef double[::1] jacobian
    cdef double[::1] error
    cdef double[::1] wrench
    cdef WrenchEquation equation

    cpdef void advance(self, double elbow) noexcept
    cpdef void solve(self, double damping) noexcept
