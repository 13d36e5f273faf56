cimport cython
from station.hw.franka.simulated.arm_step cimport ArmStep
from station.hw.franka.simulated.friction_and_observer cimport FrictionAndObserver
from station.hw.mujoco.world_step cimport WorldStep

cdef int _TOUCHED, _ASKS

cdef class SimulatedCycles:
    cdef ArmStep step
    cdef WorldStep world
    cdef object contact, state, read_disturbed, expect_load, react, supervise
    cdef double period
    cdef FrictionAndObserver observer
    cdef readonly long long cycle, seen
    @cython.locals(found=int)
    cpdef read(self)
