cimport cython
from station.core.control.loaded_controller cimport LoadedController
from station.core.control.sample_columns cimport SampleColumns
from station.memory.vectors cimport copy_into

cdef Py_ssize_t _HEAD
cdef double _NAN
cdef object _RUNNING

cdef class StateBlock:
    cdef double[::1] values
    cdef Py_ssize_t size

cdef class SnapshotRing:
    cdef readonly Py_ssize_t capacity, states, width
    cdef readonly long long newest
    cdef readonly list modes, layouts, objects
    cdef list blocks
    cdef Py_ssize_t room
    cdef readonly object memory
    cdef double[::1] rows
    cdef tuple running, layout
    @cython.locals(
        slot=Py_ssize_t, is_running=bint, block=StateBlock, one=LoadedController,
        sampled=SampleColumns)
    cpdef leave_row(
        self, long long cycle, long long epoch, double time, double period, object mode,
        tuple running)
    @cython.locals(one=LoadedController, sampled=SampleColumns)
    cpdef _lay_out(self, tuple running)
