from station.memory.vectors cimport any_of, are_finite, copy_into
from station.hw.franka.simulated.cartesian_step cimport CartesianStep
from station.hw.franka.simulated.cycle_log cimport CycleLog
from station.hw.franka.simulated.desired_motion cimport DesiredMotion
from station.core.franka.joint_memory cimport JointMemory
from station.hw.franka.simulated.joint_motors cimport JointMotors
from station.hw.franka.simulated.joint_watch cimport JointWatch
from station.hw.franka.simulated.command_check cimport CommandCheck
from station.hw.mujoco.simulator_memory cimport SimulatorMemory
from station.hw.mujoco.world_step cimport Preparation

cdef int _IDLE, _MOVE, _GUIDING, _RECOVERY
cdef int _POSITIONS, _VELOCITIES, _CARTESIAN
cdef int _CONTACT, _UNUSUAL

cdef class ArmStep(Preparation):
    cdef JointMemory memory
    cdef readonly Py_ssize_t size
    cdef double[::1] mode
    cdef DesiredMotion motion
    cdef CartesianStep cartesian
    cdef JointMotors motors
    cdef CommandCheck check
    cdef JointWatch watch
    cdef CycleLog log
    cdef SimulatorMemory simulator
    cdef public int generator
    cdef public bint wants_torques
    cdef public bint torques_act
    cdef public bint has_curves
    cdef public bint has_load
    cdef public bint has_faults
    cdef public bint is_cartesian
    cdef public bint is_following
    cdef public bint is_fresh
    cdef public bint is_begun
    cdef public bint is_lossy
    cdef public long long cycle
    cdef public double time
    cpdef bint receive_end_effector(self, double[::1] values, Py_ssize_t size)
    cpdef bint receive(self, double[::1] values, Py_ssize_t size, double[::1] place)
    cpdef bint before(self)
    cpdef bint take_command(self)
    cpdef int after(self, double time)
