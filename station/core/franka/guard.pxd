cimport cython
from station.core.franka.command_rates cimport limit_steps, limited
from station.core.geometry.clearances cimport Clearances
from station.core.geometry.distances cimport Nearness
from station.core.numerics.arm_chain cimport least_rates, place_links, zero_jacobian
from station.core.numerics.rigid_motion cimport twist_between
from station.memory.functions cimport square_root

cdef int _PASSES, _SLOWED, _CANNOT_STOP
cdef double _SLACK, _HARDEST, _BRAKING_SHARE, _CARTESIAN_SHARE, _REACTION, _CATCH_UP, _ZONE
cdef double _STIFFNESS, _DAMPING, _SINGULAR, _EXIT, _APPROACH, _JOINT_SHARE, _SOFT_BRAKE

cdef class Guard:
    cdef double[::1] chain, q_d, dq_d, ddq_d, q, dq, tau_J_d, last_pose
    cdef double[::1] last_twist, last_change, velocity, acceleration, jerk, translation
    cdef double[::1] v, way, pushing, jacobian, matrix, rest, push
    cdef readonly double[::1] committed, twist
    cdef long size, fixed
    cdef readonly long count, interventions
    cdef readonly tuple names, things
    cdef readonly dict memory
    cdef double torque_step, period, arm_margin
    cdef readonly bint is_active, is_slowing
    cdef public bint is_committing
    cdef readonly Clearances clearances
    cdef readonly list others, neighbours, places, arms
    cpdef take(self, Clearances clearances, names)
    cpdef look(self)
    @cython.locals(row=long, i=long, number=long, other=Guard, place=double[::1])
    cpdef place_others(self)
    cpdef commit(self, double[::1] q, double share)
    @cython.locals(i=long, k=long, near=Clearances)
    cdef put_places(self, double[::1] q, double share, long offset)
    @cython.locals(
        i=long, time=double, speed=double, half=double, share=double, scale=double,
        room=double, root=double,
    )
    cpdef double look_ahead(self, double[::1] q, double longest, double braking)
    @cython.locals(i=long, rate=double, way=double, most=double, soft=double)
    cpdef limit_positions(self, double[::1] result)
    @cython.locals(i=long)
    cpdef limit_velocities(self, double[::1] result)
    @cython.locals(i=long, change=double, jerk=double)
    cdef bint passes(self)
    @cython.locals(i=long, scale=double)
    cdef slow(self)
    @cython.locals(
        k=long, j=long, rate=double, size=double, most=double, soft=double,
        twist=double[::1],
    )
    cpdef int limit_pose(self, double[::1] pose)
    @cython.locals(k=long)
    cpdef int limit_twist(self, double[::1] twist)
    @cython.locals(
        k=long, change=double, most=double, was_slowing=bint, rest=double[::1]
    )
    cdef bint twist_passes(self)
    @cython.locals(
        i=long, k=long, scale=double, share=double, wanted=double, change=double,
        last=double[::1], twist=double[::1], rest=double[::1],
    )
    cdef int slow_twist(self)
    @cython.locals(i=long, share=double, size=double, most=double)
    cdef double share_within(self, double[::1] limits, double factor) noexcept
    @cython.locals(
        i=long, k=long, longest=double, size=double, total=double, twist=double[::1],
        jacobian=double[::1], links=double[::1],
    )
    cdef double look_ahead_of_twist(self)
    cdef void solve_joints(self) noexcept
    @cython.locals(
        i=long, capsule=long, solid=long, gap=double, zone=double, can_stop=bint,
        is_pushed=bint, near=Clearances,
    )
    cpdef bint limit_torques(self, double[::1] result)
    @cython.locals(
        joint=long, last=long, k=long, closing=double, force=double,
        near=Nearness, links=double[::1], px=double, py=double, pz=double, nx=double,
        ny=double, nz=double,
    )
    cdef bint repel(self, long capsule, long solid, double gap) noexcept
