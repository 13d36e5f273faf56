from station.memory.vectors cimport any_of, are_finite, copy_into
from station.hw.franka.arm.receiver cimport Receiver
from station.hw.franka.simulated.cartesian_step cimport CartesianStep
from station.hw.franka.simulated.desired_motion cimport DesiredMotion
from station.hw.franka.simulated.friction_and_observer cimport FrictionAndObserver
from station.core.franka.joint_memory cimport JointMemory
from station.hw.franka.simulated.joint_motors cimport JointMotors
from station.hw.franka.simulated.joint_watch cimport JointWatch
from station.hw.franka.simulated.motion_check cimport MotionCheck
from station.hw.franka.simulated.violations cimport Violations
from station.hw.mujoco.world_step cimport Preparation, WorldStep

cdef int _IDLE, _MOVE, _GUIDING, _RECOVERY
cdef int _NO_MOTION, _POSITIONS, _VELOCITIES, _CARTESIAN
cdef int _CONTACT, _VIOLATION, _TOUCHED, _ASKS
cdef Py_ssize_t _POSE

cdef class CycleLog:
    cdef double[::1] states, rows, commands, command_sizes, command
    cdef Py_ssize_t size, width, capacity, command_size, count
    cpdef note(self, double time)

cdef class ArmStep(Preparation):
    cdef JointMemory memory
    cdef double[::1] mode
    cdef DesiredMotion motion
    cdef CartesianStep cartesian
    cdef JointMotors motors
    cdef MotionCheck check
    cdef JointWatch watch
    cdef CycleLog log
    cdef WorldStep world
    cdef object state, actuators, load, faults, losses, plan
    cdef public object modes
    cdef public FrictionAndObserver observer
    cdef public int generator
    cdef public bint wants_torques, has_load, has_faults, is_following, is_quiet
    cdef readonly bint is_fresh, is_begun, is_lossy
    cdef readonly long long steps, seen
    cdef Py_ssize_t settling
    cpdef read_state(self)
    cpdef bint receive_end_effector(self, double[::1] values, Py_ssize_t size)
    cpdef bint receive(self, double[::1] values, Py_ssize_t size, double[::1] place)
    cdef Py_ssize_t follow_command(self)
    cdef advance_motion(self, bint arrived, bint was_lossy)
    cpdef int read_joints(self)

cdef class StepReceiver(Receiver):
    cdef ArmStep step
