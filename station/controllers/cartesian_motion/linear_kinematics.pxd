from station.memory.vectors cimport copy_into
from station.memory.functions cimport square_root
from station.controllers.cartesian_motion.cartesian_motion_generator cimport PoseMotion
from station.core.numerics.rigid_motion cimport twist_between
from station.core.numerics.arm_chain cimport WrenchEquation

cdef double _ROUNDING, _DAMPING, _NEAR

cdef class LinearKinematics:
    cdef Py_ssize_t size
    cdef double[::1] q, jacobian, dq, motion, inverse, others, columns, lengths, arms
    cdef public double[::1] velocity, acceleration
    cdef WrenchEquation equation
    cpdef void invert(self) noexcept
    cpdef void put_others(self, double[::1] columns) noexcept
    cpdef bint is_dexterous(self, double least) noexcept
    cpdef void joint_step(
        self, double[::1] way, double elbow, double[::1] step) noexcept
    cpdef void write_joint_rates(self, double[::1] motion, double[::1] result) noexcept
    cpdef void drift(self, double[::1] dq, double[::1] result) noexcept
    cpdef bint are_slow(self, double[::1] twist, double push) noexcept
    cdef bint are_pushed_little(self, double push) noexcept
    cpdef long fastest_joint(
        self, double[::1] twist, double[::1] accelerations) noexcept

cpdef double length_of(double[::1] vector) noexcept
cpdef double way_between(double[::1] first, double[::1] second) noexcept

cdef class StopPrediction:
    cdef double[::1] pose, new, lower, upper, q_d, rest, clear, way, step
    cdef double elbow, room
    cdef public LinearKinematics present, resting
    cdef Py_ssize_t size
    cpdef bint passes(self, PoseMotion motion) noexcept
    cpdef bint has_left(self) noexcept
    cpdef bint leads_away(self, PoseMotion motion) noexcept
    cpdef long limited_joint(self) noexcept
    cpdef bint may_collide(self) noexcept
    cpdef bint are_slow(self, PoseMotion motion) noexcept
    cpdef void accept(self) noexcept
    cpdef void note_clearance(self, double room) noexcept
