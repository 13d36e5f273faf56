from station.hw.mujoco.simulator_memory cimport SimulatorMemory
from station.hw.mujoco.world_step cimport Preparation

cdef class FingerMotor(Preparation):
    cdef SimulatorMemory simulator
    cdef public double stiffness
    cdef public double step
    cdef public double reach
    cdef public double target
    cdef public double place
    cdef public double force
    cpdef prepare_step(self)

cdef class FingerSensor:
    cdef SimulatorMemory simulator
    cdef double[::1] positions
    cdef double[::1] velocities
    cdef double[::1] efforts
    cdef readonly Py_ssize_t size
    cpdef read(self)
