from station.memory.vectors cimport copy_into

cdef class CycleLog:
    cdef double[::1] states, rows, commands, command_sizes
    cdef readonly Py_ssize_t size, width
    cdef Py_ssize_t capacity
    cdef public double[::1] command
    cdef public Py_ssize_t command_size
    cdef readonly long long count
    cpdef note(self, double time)
