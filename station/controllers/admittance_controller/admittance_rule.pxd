from station.core.numerics.arm_chain cimport (
    JointChain, WrenchEquation, torques_of, turn_to_inner_axes, turn_to_outer_axes,
    twist_of)
from station.core.numerics.rigid_motion cimport twist_between

cdef class AdmittanceRule:
    cdef Py_ssize_t size
    cdef JointChain sensor, reference, control, centre
    cdef WrenchEquation equation
    cdef double[::1] measured, turned, arm, sum
    cdef readonly double[::1] wrench, weight, centre_of_gravity, selected, inverse_mass
    cdef readonly double[::1] damping, stiffness, force, error, velocity
    cdef readonly double[::1] positions, velocities, accelerations
    cdef public double smoothing, inverse_damping, joint_damping
    cpdef void compute_motion(
        self, double[::1] q, double[::1] q_ref, double period) noexcept
