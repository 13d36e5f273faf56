from station.controllers.franka_arm.cartesian_spring cimport PoseSpring
from station.core.numerics.command_rates cimport filter_commands
from station.core.numerics.arm_chain cimport torques_of, twist_of
from station.memory.functions cimport exponential, square_root

cdef double _FILTER, _INVERSE_DAMPING, _SMALLEST_EXPONENT

cdef double logistic(double value) noexcept

cdef class Friction:
    cdef double[::1] dq, height, slope, shift
    cdef public double share
    cdef void compensate(self, double[::1] torques) noexcept

cdef class PoseImpedance(PoseSpring):
    cdef readonly double[::1] axes, wanted_axes, dampings, posture
    cdef public Friction friction
    cdef public double slowing, largest_force, largest_torque
    cdef double bounded(self, Py_ssize_t first, double largest) noexcept

cdef class JointImpedance:
    cdef Py_ssize_t size
    cdef double largest_step
    cdef double[::1] q, dq, last_torques
    cdef Friction friction
    cdef readonly double[::1] stiffness, wanted, dampings, desired, target, coriolis
    cdef readonly double[::1] errors, torques
    cpdef void compute_torques(self) noexcept
