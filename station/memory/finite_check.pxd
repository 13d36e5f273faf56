from station.memory.vectors cimport are_finite

cdef class FiniteCheck:
    cdef double[::1] memory
    cdef readonly Py_ssize_t size
    cpdef Py_ssize_t first_bad(self)
