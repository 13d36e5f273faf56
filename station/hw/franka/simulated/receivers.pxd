cimport cython
from station.core.franka.joint_memory cimport JointMemory
from station.hw.franka.arm.receiver cimport Receiver
from station.hw.franka.simulated.arm_step cimport ArmStep

cdef int _POSITIONS, _VELOCITIES, _CARTESIAN
cdef Py_ssize_t _POSE

cdef class StepReceiver(Receiver):
    cdef ArmStep step
    cdef JointMemory memory
    @cython.locals(step=ArmStep, memory=JointMemory)
    cpdef bint receive_torques(self, double[::1] tau)
    cpdef bint receive_positions(self, double[::1] q)
    cpdef bint receive_velocities(self, double[::1] dq)
    @cython.locals(step=ArmStep, memory=JointMemory)
    cpdef bint receive_target(self, double[::1] values, int generator)
    @cython.locals(step=ArmStep)
    cpdef bint receive_pose(self, double[::1] pose)
    cpdef bint rests_at_pose(self)
