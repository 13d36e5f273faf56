cdef class UsualUpdate:
    cpdef bint run(self, double time, double period) except -1
