cimport cython
from station.memory.vectors cimport are_finite, copy_into, differ

cdef class CommandBlock:
    cdef readonly object slots
    cdef readonly object values
    cpdef bint copy_commands(self) except -1
    cpdef bint has_changed(self) except -1
    cpdef write_copy(self)

cdef class DoublesBlock(CommandBlock):
    cdef double[::1] memory
    cdef double[::1] copy
    cdef Py_ssize_t size
    cpdef bint copy_commands(self) except -1
    cpdef bint has_changed(self) except -1
    cpdef write_copy(self)

cdef class ListBlock(CommandBlock):
    cdef list storage
    cdef list copy
    cdef object place
    cpdef bint copy_commands(self) except -1
    cpdef bint has_changed(self) except -1
    cpdef write_copy(self)

cdef class CommandGate:
    cdef public bint is_stale
    cdef public long traced_cycles
    cdef readonly tuple running
    cdef readonly long violations
    cdef readonly object last_violation
    cdef list guards
    cdef list resting
    cdef list kept
    cdef Py_ssize_t next_compared
    cdef set owned_names
    cdef dict names
    cdef dict slots
    @cython.locals(kept=list, place=Py_ssize_t, block=CommandBlock, each=CommandBlock)
    cpdef keep_commands(self)
