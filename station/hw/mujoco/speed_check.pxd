from station.memory.vectors cimport are_within

cdef class SpeedCheck:
    cdef double[::1] velocities, shares
    cdef readonly Py_ssize_t size
    cdef double slowest
    cpdef bint holds(self)
