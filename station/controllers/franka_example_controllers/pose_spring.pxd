from station.core.numerics.arm_chain cimport torques_of, twist_of
from station.memory.functions cimport arctangent, sine, square_root
from station.core.franka.command_rates cimport limit_steps
from station.core.numerics.rigid_motion cimport quaternion_of
from station.core.numerics.wrench_equation cimport WrenchEquation

cdef double _FILTER, _INVERSE_DAMPING, _CLOSE

cdef class PoseSpring:
    cdef readonly Py_ssize_t size
    cdef bint is_angle
    cdef double largest_step
    cdef double[::1] q
    cdef double[::1] dq
    cdef readonly double[::1] pose
    cdef double[::1] last_torques
    cdef readonly double[::1] jacobian
    cdef readonly double[::1] coriolis
    cdef readonly double[::1] torques
    cdef readonly double[::1] equilibrium
    cdef readonly double[::1] target
    cdef readonly double[::1] stiffness
    cdef readonly double[::1] wanted
    cdef double[::1] damping
    cdef double[::1] rest
    cdef double[::1] stray
    cdef double[::1] error
    cdef double[::1] twist
    cdef double[::1] wrench
    cdef double[::1] quaternion
    cdef WrenchEquation equation

    cpdef void start_at_rest(self, double nullspace) noexcept
    cpdef void compute_torques(self) noexcept
    cpdef void measure_error(self) noexcept
    cpdef void balance_error(self) noexcept
    cpdef void approach_targets(self) noexcept
