cdef class Receiver:
    cpdef bint receive(self, double[::1] values, int kind)
    cpdef bint rests_at_pose(self)
