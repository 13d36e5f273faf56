from station.core.franka.joint_memory cimport JointMemory

cdef class CommandCheck:
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef double[::1] lower
    cdef double[::1] upper
    cdef double[::1] velocity
    cdef double[::1] acceleration
    cdef double[::1] jerk
    cdef double[::1] reached
    cdef double torque_step
    cdef double period
    cpdef bint admit_positions(self)
    cpdef bint admit_velocities(self)
    cpdef bint admit(self, double[::1] q, double[::1] dq)
    cpdef bint admit_torques(self)
