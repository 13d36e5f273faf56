from station.hw.mujoco.simulator_memory cimport SimulatorMemory
from station.hw.mujoco.world_step cimport Preparation

cdef class FingerMotor(Preparation):
    cdef SimulatorMemory simulator
    cdef public double stiffness, step, reach, target, place, force

cdef class FingerSensor:
    cdef SimulatorMemory simulator
    cdef double[::1] positions, velocities, efforts
    cdef readonly Py_ssize_t size
