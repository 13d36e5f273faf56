from station.memory.vectors cimport copy_into
from station.core.franka.joint_memory cimport JointMemory
from station.hw.mujoco.simulator_memory cimport SimulatorMemory

cdef class JointMotors:
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef SimulatorMemory simulator
    cdef double period
    cdef public double[::1] stiffness
    cdef public double[::1] damping
    cdef public double[::1] load_weight
    cdef double[::1] limits
    cdef double[::1] passive
    cdef double[::1] rotor
    cdef double[::1] drag
    cdef public bint is_loaded
    cdef public bint is_late
    cdef public bint torques_act
    cdef public bint is_cartesian
    cdef bint is_new
    cdef double[::1] late_torques
    cdef double[::1] late_q
    cdef double[::1] late_dq
    cdef double[::1] late_ddq
    cpdef note_motion(self)
    cpdef apply_torques(self)
    cpdef apply_impedance(self, bint notes)
    cpdef sense(self)
    cpdef differentiate(self)
