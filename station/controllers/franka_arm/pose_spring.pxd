from station.core.numerics.arm_chain cimport WrenchEquation, torques_of, twist_of
from station.memory.functions cimport arctangent, sine, square_root
from station.core.numerics.command_rates cimport filter_commands
from station.core.numerics.rigid_motion cimport quaternion_of

cdef double _FILTER, _INVERSE_DAMPING, _CLOSE

cdef class PoseSpring:
    cdef readonly Py_ssize_t size
    cdef bint is_angle
    cdef double largest_step
    cdef double[::1] q, dq, last_torques, damping, stray, twist, wrench, quaternion
    cdef readonly double[::1] pose, jacobian, coriolis, torques, equilibrium, target
    cdef readonly double[::1] stiffness, wanted, error, rest
    cdef WrenchEquation equation
    cpdef void compute_torques(self) noexcept
    cpdef void balance_error(self) noexcept
    cpdef void approach_targets(self) noexcept
