from station.memory.finite_check cimport FiniteCheck
from station.hw.franka.arm.flags cimport MotionFlags
from station.core.hardware.stages cimport Stage

cdef class FingerReading:
    cpdef read(self)

cdef class ArmReading(Stage):
    cdef object read_once
    cdef FiniteCheck readings
    cdef MotionFlags motion
    cdef double cycle_time
    cdef object catch_up
    cdef object end_motion
    cdef public FingerReading fingers
    cdef public double time_due
    cdef public long nominal
    cdef readonly long bad
    cpdef run(self, double time, double period)
