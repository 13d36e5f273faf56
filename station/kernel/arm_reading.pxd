cimport cython
from station.kernel.arm_step cimport ArmStep
from station.kernel.finger_motor cimport FingerSensor
from station.kernel.finite_check cimport FiniteCheck
from station.kernel.flags cimport AlertFlag, ContactFlag, MotionFlags
from station.kernel.imperfections cimport Imperfections
from station.kernel.stages cimport Stage
from station.kernel.world_step cimport WorldStep

cdef class Cycles:
    cpdef read(self)

cdef class CalledCycles(Cycles):
    cdef object function
    cpdef read(self)

cdef class SimulatedCycles(Cycles):
    cdef ArmStep step
    cdef WorldStep world
    cdef object state
    cdef double period
    cdef ContactFlag contact
    cdef AlertFlag supervisor
    cdef object read_closely
    cdef Imperfections imperfections
    cdef object expect_load
    cdef object attend
    cdef object supervise
    cdef readonly long long cycle
    cdef readonly long long seen
    @cython.locals(found=int, unusual=int, steps="long long", time=double)
    cpdef read(self)

cdef class ArmReading(Stage):
    cdef Cycles cycles
    cdef FiniteCheck readings
    cdef MotionFlags motion
    cdef double cycle_time
    cdef object catch_up
    cdef object end_motion
    cdef public FingerSensor fingers
    cdef public double time_due
    cdef public long nominal
    cdef readonly long bad
    cpdef run(self, double time, double period)
