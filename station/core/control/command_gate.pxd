cimport cython
from station.memory.vectors cimport are_finite, copy_into, differ

cdef class CommandBlock:
    cdef readonly object slots, values
    cpdef bint copy_commands(self) except -1
    cpdef bint has_changed(self) except -1
    cpdef write_copy(self)

cdef class DoublesBlock(CommandBlock):
    cdef double[::1] memory, copy
    cdef Py_ssize_t size

cdef class ListBlock(CommandBlock):
    cdef list storage, copy
    cdef object place

cdef class CommandGate:
    cdef public bint is_stale
    cdef public long traced_cycles
    cdef readonly tuple running
    cdef readonly long violations
    cdef readonly object last_violation
    cdef list guards, resting, kept
    cdef Py_ssize_t next_compared
    cdef set owned_names
    cdef dict names, slots
    @cython.locals(block=CommandBlock, each=CommandBlock)
    cpdef keep_commands(self)
