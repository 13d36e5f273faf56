from station.core.numerics.arm_chain cimport place_links, twist_of, zero_jacobian
from station.hw.franka.arm.capsules cimport LinkDistances
from station.hw.franka.arm.velocity_curves cimport VelocityCurves
from station.memory.functions cimport square_root
from station.core.franka.joint_memory cimport JointMemory
from station.core.numerics.rigid_motion cimport compose, rotation_between
from station.hw.franka.simulated.violations cimport Violations

cdef double _REACH

cdef class JointWatch:
    cdef readonly Py_ssize_t size
    cdef readonly Violations violations
    cdef JointMemory memory
    cdef object limits
    cdef VelocityCurves curves
    cdef double[::1] chain, tool, links, flange, pose, desired, jacobian, twist, lower
    cdef double[::1] upper, slowest, fastest, torque, walls
    cdef double reach_in_a_cycle, speed, power, translation, rotation, elbow
    cdef double least_distance
    cdef LinkDistances distances
    cdef public double room
    cdef bint has_curves, limits_power
    cdef public bint is_alert
    cpdef bint check_readings(self, bint is_following, bint has_moved)
    cdef check_distances(self)
    cdef check_speed(self)
    cdef check_power(self)
    cdef check_deviation(self)
    cdef void place(self, double[::1] q, double[::1] pose) noexcept

cdef double _length(double[::1] vector) noexcept
