from station.memory.vectors cimport copy_into
from station.memory.functions cimport square_root

cpdef void low_pass(
    double[::1] values,
    double[::1] last,
    double gain,
    double[::1] result,
    Py_ssize_t size,
) noexcept
cpdef double limited(
    double velocity,
    double last_velocity,
    double last_acceleration,
    double acceleration,
    double jerk,
    double lowest_velocity,
    double highest_velocity,
    double period,
) noexcept

cpdef void limit_steps(
    double[::1] values, double[::1] last, double largest
) noexcept

cdef class CommandRates:
    cdef double[::1] tau_J_d
    cdef double[::1] q_d
    cdef double[::1] dq_d
    cdef double[::1] ddq_d
    cdef readonly Py_ssize_t size
    cdef double[::1] positions
    cdef double[::1] velocities
    cdef double[::1] efforts
    cdef double[::1] velocity
    cdef double[::1] acceleration
    cdef double[::1] jerk
    cdef double[::1] stopping
    cdef double torque_step
    cdef bint passes_first
    cdef double[::1] lower
    cdef double[::1] upper
    cdef double approach_gain
    cdef double period
    cdef public double gain
    cdef public bint is_limiting
    cdef public double[::1] lowest
    cdef public double[::1] highest
    cdef public double[::1] goals
    cdef double[::1] last_goals
    cdef public bint has_goals
    cdef public bint passes_next
    cdef public double[::1] result
    cpdef begin_motion(self, double gain, bint is_limiting)
    cpdef note_goals(self)
    cpdef filter_torques(self)
    cpdef filter_velocities(self)
    cpdef filter_positions(self)
