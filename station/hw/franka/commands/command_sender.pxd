cimport cython
from station.core.numerics.command_rates cimport CommandRates
from station.core.geometry.guard cimport Guard
from station.core.hardware.limits.limited_joints cimport EnforcedLimits
from station.hw.franka.arm.receiver cimport Receiver
from station.hw.franka.arm.velocity_curves cimport VelocityCurves
from station.hw.franka.commands.cartesian_sender cimport CartesianSender
from station.memory.vectors cimport FiniteCheck

cdef int _MOVE, _TORQUES, _POSITIONS, _VELOCITIES

cdef class CommandSender:
    cdef object arm, joints, cartesian, hand, write_fingers
    cdef VelocityCurves curves
    cdef Receiver receiver
    cdef double[::1] code
    cdef double last_code
    cdef str last_name
    cdef dict claimed, mode_names
    cdef CartesianSender cartesian_sender
    cdef CommandRates rates
    cdef list checks, limits
    cdef public bint is_active, is_waiting
    cdef bint has_positions, has_velocities, has_efforts, has_pose, has_twist
    cdef public object refusal
    cdef readonly Guard guard
    @cython.locals(check=FiniteCheck, limits=EnforcedLimits)
    cpdef write(self, double time, double period)
    cpdef send_all(self, bint is_new)
    cpdef send_positions(self)
    cpdef send_velocities(self)
    cpdef send_torques(self)
