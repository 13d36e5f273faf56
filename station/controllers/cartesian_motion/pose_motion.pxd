from station.memory.functions cimport square_root
from station.memory.vectors cimport copy_into
from station.core.numerics.rigid_motion cimport displace, rotation_between


cpdef void resting_ways(
    double[::1] velocities,
    double[::1] accelerations,
    double[::1] largest,
    double[::1] jerks,
    double[::1] ways,
) noexcept
cpdef void braking_peaks(
    double[::1] velocities,
    double[::1] accelerations,
    double[::1] largest,
    double[::1] jerks,
    double[::1] peaks,
) noexcept
cpdef double peak_speed(
    double[::1] velocities, double[::1] accelerations, double[::1] jerks
) noexcept

cdef double _AT_REST
cdef Py_ssize_t _POSE, _AXES

cdef class PoseMotion:
    cdef double[::1] pose
    cdef double[::1] target
    cdef double[::1] twist
    cdef double[::1] velocity
    cdef double[::1] turn
    cdef double[::1] accelerations
    cdef double[::1] acceleration
    cdef double[::1] forward
    cdef double[::1] spin
    cdef double[::1] peaks
    cdef double[::1] largest
    cdef double[::1] jerk
    cdef double[::1] forward_jerk
    cdef double[::1] spin_jerk
    cdef double fastest
    cdef double fastest_turn
    cdef readonly double[::1] resting
    cdef double[::1] last
    cdef double[::1] way
    cdef double[::1] there
    cdef list aimed_at

    cpdef list aim(self)
    cpdef list coordinates(self)
    cpdef list move(self, list positions, list velocities, list accelerations)
    cpdef undo(self, list velocities, list accelerations)
    cpdef take_rates(self, list velocities, list accelerations)
    cpdef bint is_at_rest(self) noexcept
    cpdef void brake(self) noexcept
    cpdef bint stays_within_speed(self) noexcept
