cdef class Receiver:
    cdef object function
    cpdef receive(self, double[::1] values)

cdef class PoseReceiver:
    cpdef bint is_open(self) except -1
    cpdef bint is_settled(self) except -1
    cpdef bint receive(self, double[::1] pose) except -1
