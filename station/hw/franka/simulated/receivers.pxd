cimport cython
from station.hw.franka.arm.receiver cimport PoseReceiver, Receiver
from station.hw.franka.simulated.arm_step cimport ArmStep

cdef int _CARTESIAN
cdef Py_ssize_t _POSE

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

cdef class EndEffectorReceiver(PoseReceiver):
    cdef ArmStep step
    cpdef bint is_open(self) except -1
    cpdef bint is_settled(self) except -1
    cpdef bint receive(self, double[::1] pose) except -1
