cimport cython
from station.core.franka.joint_memory cimport JointMemory
from station.hw.mujoco.simulator_memory cimport SimulatorMemory
from station.hw.mujoco.world_step cimport Preparation
from station.core.numerics.arm_chain cimport place_links, zero_jacobian
from station.core.numerics.rigid_motion cimport compose
from station.core.numerics.wrench_equation cimport WrenchEquation
from station.memory.functions cimport exponential

cdef int _WEAK, _TOUCHED, _LOST
cdef double _LARGEST_POWER, _RELAXATION

cdef class FrictionAndObserver(Preparation):
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef SimulatorMemory simulator
    cdef WrenchEquation equation
    cdef double[::1] chain, tool, stiffness_frame, links, flange, noise, estimate, theta
    cdef double[::1] wrench, turned, offset, velocity, change, momentum
    cdef double period, rate, following
    cdef readonly double[::1] level, slope, shift, static_friction, compliance, bristle
    cdef readonly double[::1] torque_noise, torque_bias, velocity_noise, model_error
    cdef readonly double[::1] expected, lower, jacobian, pose, place, directions, shares
    cdef readonly double[::1] doubt, lasting
    cdef public double stribeck_velocity, presliding, reach, gain, singular, reliable
    cdef public double lasting_gain
    cdef readonly bint has_wrench
    cdef public Py_ssize_t weak
    cdef Py_ssize_t drawn
    cdef public long cycles_to_loss

    cpdef settle(self)
    cpdef rest(self)
    cpdef bint renew_jacobian(self)
    @cython.locals(is_reliable=bint, i=Py_ssize_t, singular=double, reliable=double)
    cpdef bint factorise_jacobian(self)
    @cython.locals(i=Py_ssize_t, power=double, velocity=double, sliding=double, relative=double, most=double, bend=double, share=double, turn=double, lead=double)
    cpdef prepare_step(self)
    @cython.locals(i=Py_ssize_t, result=int, reach=double)
    cpdef int sense(self)
    @cython.locals(i=Py_ssize_t, drawn=Py_ssize_t, last=Py_ssize_t, rate=double, measured=double, error=double)
    cpdef disturb(self)
    @cython.locals(i=Py_ssize_t, j=Py_ssize_t, row=Py_ssize_t, total=double, element=double, own=double, rate=double, gain=double, needed=double, external=double, following=double)
    cpdef observe(self)
    @cython.locals(i=Py_ssize_t, k=Py_ssize_t, axis=Py_ssize_t, torque=double, u=double, v=double, w=double, a=double, b=double, c=double, x=double, y=double, z=double)
    cpdef compute_wrench(self)
    @cython.locals(i=Py_ssize_t, j=Py_ssize_t, k=Py_ssize_t, size=Py_ssize_t, most=double, part=double)
    cpdef doubt_wrench(self)
    @cython.locals(i=Py_ssize_t, size=Py_ssize_t)
    cpdef bint is_touched(self)
