cimport cython
from station.kernel.arm_step cimport ArmStep
from station.kernel.command_rates cimport CommandRates
from station.kernel.enforced_limits cimport EnforcedLimits
from station.kernel.finite_check cimport FiniteCheck
from station.kernel.pose_sending cimport PoseSend

cdef class Receiver:
    cdef object function
    cpdef receive(self, double[::1] values)

cdef class TorqueReceiver(Receiver):
    cdef ArmStep step
    cdef Py_ssize_t size
    cdef double[::1] place
    @cython.locals(step=ArmStep)
    cpdef receive(self, double[::1] values)

cdef class JointReceiver(Receiver):
    cdef ArmStep step
    cdef Py_ssize_t size
    cdef double[::1] place
    cdef int generator
    @cython.locals(step=ArmStep)
    cpdef receive(self, double[::1] values)

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
