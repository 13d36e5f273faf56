from station.controllers.smoothed_motion.motion_generator cimport MotionGenerator
from station.core.numerics.rigid_motion cimport displace, rotation_between
from station.memory.functions cimport square_root
from station.memory.vectors cimport copy_into

cdef double _AT_REST
cdef Py_ssize_t _POSE, _AXES

cpdef double peak_speed(
    double[::1] velocities, double[::1] accelerations, double[::1] jerks) noexcept

cdef class PoseMotion:
    cdef double[::1] pose, target, twist, velocity, turn, accelerations, acceleration
    cdef double[::1] forward, spin, peaks, largest, jerk, forward_jerk, spin_jerk, last
    cdef double[::1] way, there
    cdef double fastest, fastest_turn
    cdef readonly double[::1] resting
    cdef list aimed_at
    cpdef list aim(self)
    cpdef list coordinates(self)
    cpdef list move(self, list positions, list velocities, list accelerations)
    cpdef take_rates(self, list velocities, list accelerations)
    cpdef bint is_at_rest(self) noexcept
    cpdef void brake(self) noexcept
    cpdef bint stays_within_speed(self) noexcept

cdef class CartesianMotionGenerator:
    cdef MotionGenerator _generator
    cdef readonly object pose, twist, accelerations
    cdef object _target, _wanted
    cdef readonly PoseMotion motion
    cdef tuple _last
    cpdef bint is_still(self)
    cpdef advance(self, double period)
