from station.core.franka.joint_memory cimport JointMemory
from station.hw.mujoco.simulator_memory cimport SimulatorMemory
from station.hw.mujoco.world_step cimport Preparation
from station.core.numerics.arm_chain cimport WrenchEquation, place_links, zero_jacobian
from station.core.numerics.rigid_motion cimport compose
from station.memory.functions cimport exponential

cdef int _WEAK, _TOUCHED, _LOST
cdef double _LARGEST_POWER, _RELAXATION
cdef unsigned long long _FACTOR, _STEP, _MASK

cdef class FrictionAndObserver(Preparation):
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef SimulatorMemory simulator
    cdef WrenchEquation equation
    cdef double[::1] chain, tool, stiffness_frame, links, flange, noise, estimate, theta
    cdef double[::1] wrench, turned, offset, velocity, change, momentum
    cdef double period, rate, following
    cdef readonly double[::1] level, slope, shift, static_friction, compliance, bristle
    cdef readonly double[::1] viscous, torque_noise, torque_bias, velocity_noise
    cdef readonly double[::1] model_error, expected, lower, jacobian, pose, place
    cdef readonly double[::1] directions, shares, doubt, lasting
    cdef public double stribeck_velocity, presliding, reach, gain, singular, reliable
    cdef public double lasting_gain
    cdef readonly bint has_wrench
    cdef public Py_ssize_t weak
    cdef unsigned long long dice
    cdef public long cycles_to_loss
    cpdef int sense(self)
    cdef disturb(self)
    cdef observe(self)
    cdef compute_wrench(self)
    cdef doubt_wrench(self)
    cdef bint is_touched(self)
