cimport cython
from station.hw.franka.simulated.arm_step cimport ArmStep
from station.hw.franka.simulated.friction_and_observer cimport FrictionAndObserver
from station.hw.mujoco.world_step cimport WorldStep

cdef int _TOUCHED, _ASKS

cdef class ContactFlag:
    cdef public bint is_quiet

cdef class AlertFlag:
    cdef public bint is_alert

cdef class SimulatedCycles:
    cdef ArmStep step
    cdef WorldStep world
    cdef object state
    cdef double period
    cdef ContactFlag contact
    cdef AlertFlag supervisor
    cdef object read_disturbed
    cdef FrictionAndObserver observer
    cdef object expect_load, react, supervise
    cdef readonly long long cycle, seen
    @cython.locals(found=int, observed=int, steps="long long", time=double)
    cpdef read(self)
