from station.memory.vectors cimport copy_into
from station.core.franka.joint_memory cimport JointMemory
from station.hw.mujoco.simulator_memory cimport SimulatorMemory

cdef class JointMotors:
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef SimulatorMemory simulator
    cdef double period
    cdef public double[::1] stiffness, damping, load_weight
    cdef double[::1] limits, passive, rotor, drag, late_torques, late_q, late_dq
    cdef double[::1] late_ddq
    cdef public bint is_loaded, is_late, torques_act, is_cartesian
    cdef bint is_new
    cpdef note_motion(self)
    cpdef apply_torques(self)
    cpdef apply_impedance(self, bint notes)
    cpdef sense(self)
