from station.core.franka.joint_memory cimport JointMemory
from station.hw.franka.arm.velocity_curves cimport VelocityCurves
from station.hw.franka.simulated.violations cimport Violations
from station.memory.functions cimport square_root

cdef double _ROUNDING

cdef class MotionCheck:
    cdef readonly Py_ssize_t size
    cdef readonly Violations violations
    cdef JointMemory memory
    cdef object limits
    cdef VelocityCurves curves
    cdef double[::1] before, lower, upper, slowest, fastest, acceleration, jerk
    cdef double[::1] translation, rotation, elbow, reached
    cdef double torque_step, period, unseen
    cpdef Py_ssize_t check_positions(self, int code)
    cpdef Py_ssize_t check_velocities(self)
    cdef Py_ssize_t check_joints(self, double[::1] q, double[::1] dq, int code)
    cpdef Py_ssize_t check_torques(self)
    cpdef Py_ssize_t check_twist(
        self, double[::1] twist, double[::1] last, double[::1] last_rate)
    cdef check_part(
        self, Py_ssize_t first, double[::1] twist, double[::1] last,
        double[::1] last_rate, double[::1] bounds)
    cdef check_bounds(
        self, Py_ssize_t first, double velocity, double acceleration, double jerk,
        double[::1] bounds)
