cimport cython
from station.memory.vectors cimport copy_into

cdef class Column:
    cdef double[::1] values
    cdef Py_ssize_t size

cdef class SampleColumns:
    cdef tuple views
    cdef list columns
    cdef readonly Py_ssize_t size, width
    cdef double[::1] row, stamp
    cdef object packed
    @cython.locals(column=Column)
    cpdef keep(self, double stamp)
