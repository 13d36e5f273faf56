cimport cython
from station.core.control.loaded_controller cimport LoadedController
from station.core.control.sample_columns cimport Column
from station.memory.vectors cimport copy_into

cdef Py_ssize_t _HEAD
cdef double _NAN
cdef object _RUNNING

cdef class SnapshotRing:
    cdef readonly Py_ssize_t capacity, states, width
    cdef readonly long long newest
    cdef readonly list modes, layouts, objects
    cdef list blocks
    cdef Py_ssize_t room
    cdef readonly object memory
    cdef double[::1] rows
    cdef tuple running, layout
    @cython.locals(is_running=bint, block=Column, one=LoadedController)
    cpdef leave_row(
        self, long long cycle, long long epoch, double time, double period, object mode,
        tuple running)
