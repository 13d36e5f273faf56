cimport cython
from station.hw.franka.arm.receiver cimport Receiver
from station.core.franka.command_rates cimport CommandRates
from station.core.hardware.limits.enforced_limits cimport EnforcedLimits
from station.memory.finite_check cimport FiniteCheck
from station.hw.franka.commands.pose_sending cimport PoseSend

cdef class JointSend:
    cdef CommandRates rates
    cdef Receiver receiver
    cdef object prepare
    cdef double[::1] result
    cpdef send(self)

cdef class PositionSend(JointSend):
    cpdef send(self)

cdef class VelocitySend(JointSend):
    cpdef send(self)

cdef class TorqueSend(JointSend):
    cpdef send(self)

cdef class CommandSending:
    cdef public list checks
    cdef public list limits
    cdef public list sends
    cdef public CommandRates goals
    cdef public bint is_cartesian
    cdef public PoseSend pose_send
    @cython.locals(check=FiniteCheck, limits=EnforcedLimits, one=JointSend)
    cpdef send_limited(self, double period)
