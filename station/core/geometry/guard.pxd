cimport cython
from station.core.numerics.command_rates cimport filter_commands, limited
from station.core.geometry.clearances cimport Clearances
from station.core.numerics.arm_chain cimport least_rates, place_links, zero_jacobian
from station.core.numerics.rigid_motion cimport twist_between
from station.memory.functions cimport square_root

cdef int _PASSES, _SLOWED, _CANNOT_STOP
cdef double _SLACK, _HARDEST, _BRAKING_SHARE, _CARTESIAN_SHARE, _CATCH_UP
cdef double _ZONE
cdef double _STIFFNESS, _DAMPING, _SINGULAR, _EXIT, _APPROACH, _JOINT_SHARE, _SOFT_BRAKE

cdef class Guard:
    cdef double[::1] chain, q, dq, tau_J_d, last_pose
    cdef readonly double[::1] q_d, dq_d, ddq_d
    cdef double[::1] last_twist, last_change, velocity, acceleration, jerk, translation
    cdef double[::1] way, pushing, jacobian, matrix, rest, push
    cdef readonly double[::1] committed, twist, v
    cdef long size, fixed
    cdef readonly long count, interventions
    cdef readonly tuple names, things
    cdef readonly dict memory
    cdef double torque_step, reaction, arm_margin
    cdef public double period
    cdef readonly bint is_active, is_slowing
    cdef public bint is_committing
    cdef readonly Clearances clearances
    cdef readonly list others, neighbours, places, arms
    cpdef look(self)
    @cython.locals(number=long, other=Guard, place=double[::1])
    cpdef place_others(self)
    cpdef commit(self, double[::1] q, double share)
    cdef put_places(self, double[::1] q, double share, long offset)
    cpdef double look_ahead(self, double[::1] q, double longest, double braking)
    cpdef limit_positions(self, double[::1] result)
    cpdef limit_velocities(self, double[::1] result)
    cpdef bint passes(self)
    cpdef slow(self)
    cpdef catch_up(self, double[::1] result)
    cpdef int limit_pose(self, double[::1] pose)
    cpdef int limit_twist(self, double[::1] twist)
    cdef bint twist_passes(self)
    cdef int slow_twist(self)
    cdef double share_within(self, double[::1] limits, double factor) noexcept
    cdef double look_ahead_of_twist(self)
    cdef void solve_joints(self) noexcept
    @cython.locals(can_stop=bint, is_pushed=bint)
    cpdef bint limit_torques(self, double[::1] result)
    cdef bint repel(self, long capsule, long solid, double gap) noexcept
