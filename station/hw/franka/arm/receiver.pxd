cdef class Receiver:
    cpdef bint receive_torques(self, double[::1] tau)
    cpdef bint receive_positions(self, double[::1] q)
    cpdef bint receive_velocities(self, double[::1] dq)
    cpdef bint receive_pose(self, double[::1] pose)
    cpdef bint rests_at_pose(self)
