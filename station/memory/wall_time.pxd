cpdef double wall_time()

cdef class VirtualTime:
    cdef public double seconds
