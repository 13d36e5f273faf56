cimport cython
from station.core.control.controller_round cimport ControllerRound
from station.core.numerics.durations cimport CycleTimes
from station.core.hardware.stages cimport Stage
from station.memory.wall_time cimport VirtualTime, wall_time

cdef class StopFlag:
    cdef public bint pending

cdef class ControlCycle:
    cdef public Stage reading
    cdef ControllerRound updating
    cdef public Stage writing
    cdef CycleTimes times
    cdef object now
    cdef VirtualTime virtual
    cdef object refresh
    cdef object waiting
    cdef StopFlag latch
    cdef unsigned char[::1] stop_flags
    cdef public tuple taps
    cdef public double time
    cdef public long long cycle
    cdef public long long epoch
    cdef public double longest_period
    cdef public long late_cycles
    @cython.locals(done=long)
    cpdef long run(self, long cycles, double period, double tick=*)
    @cython.locals(time=double, begun=double, read=double, updated=double)
    cpdef run_one(self, double period)
    cpdef double wall_time(self)
    @cython.locals(cycle="long long", epoch="long long", time=double)
    cpdef leave(self, double period)
