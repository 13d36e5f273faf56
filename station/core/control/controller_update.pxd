cimport cython
from station.core.control.command_gate cimport CommandBlock, CommandGate
from station.core.control.loaded_controller cimport LoadedController
from station.memory.wall_time cimport wall_time

cdef object _RUNNING
cdef double _INF

cdef class ControllerUpdate:
    cdef readonly object lifecycle, changes
    cdef readonly CommandGate gate
    cdef object hw, is_interrupted, transaction
    cdef public tuple interrupted
    cdef public double update_budget
    cdef readonly long long cycle
    cdef readonly double time
    cdef readonly long thread
    cdef readonly bint is_updating
    cdef public object pending, stopwatch
    cdef public bint resets
    @cython.locals(one=LoadedController)
    cpdef update_controllers(self, double time, double period, bint stands_still=*)
    @cython.locals(begin=double, duration=double, block=CommandBlock)
    cpdef update_controller(self, LoadedController one, double time, double period)
