from station.core.control.controller_update cimport ControllerUpdate
from station.core.loop.snapshot cimport SnapshotRing
from station.core.numerics.durations cimport CycleTimes
from station.memory.wall_time cimport VirtualTime, wall_time

cdef double _INF

cdef class ControlCycle:
    cdef object hw, mode, manager, refresh_joints, operations, waiting, stop_latch
    cdef object heartbeat, now
    cdef ControllerUpdate controllers
    cdef SnapshotRing snapshots
    cdef unsigned char[::1] latch_flag, stop_flags
    cdef CycleTimes times
    cdef VirtualTime virtual
    cdef list interruptible
    cdef public tuple taps
    cdef public double time, longest_period
    cdef public long long cycle, epoch
    cdef public long late_cycles
    cpdef long run_cycles(self, long cycles, double period, double tick=*)
    cpdef run_cycle(self, double period)
    cpdef double wall_time(self)
    cpdef leave_row(self, double period)
