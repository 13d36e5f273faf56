from station.memory.vectors cimport copy_into
from station.memory.functions cimport square_root

cdef double _INF

cpdef void filter_commands(
    double[::1] values, double[::1] last, double gain, double largest,
    double[::1] result, Py_ssize_t size) noexcept
cpdef double limited(
    double velocity, double last_velocity, double last_acceleration,
    double acceleration, double jerk, double lowest_velocity, double highest_velocity,
    double period) noexcept

cdef class CommandRates:
    cdef double[::1] tau_J_d, q_d, dq_d, ddq_d, positions, velocities, efforts, velocity
    cdef double[::1] acceleration, jerk, stopping, lower, upper, last_goals
    cdef readonly Py_ssize_t size
    cdef double torque_step, approach_gain, period
    cdef bint passes_first
    cdef public double gain
    cdef public bint is_limiting, has_goals, passes_next
    cdef public double[::1] lowest, highest, goals, result
    cpdef note_goals(self)
    cpdef filter_torques(self)
    cpdef filter_velocities(self)
    cpdef filter_positions(self)
