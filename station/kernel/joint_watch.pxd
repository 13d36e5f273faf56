from station.kernel.joint_memory cimport JointMemory

cdef class JointWatch:
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef double[::1] lower
    cdef double[::1] upper
    cdef double[::1] velocity
    cdef double[::1] torque
    cdef double reach
    cdef double reach_in_a_cycle
    cdef double speed
    cdef double power
    cdef double translation
    cdef double rotation
    cdef double elbow
    cdef public double room
    cdef readonly double total_power
    cpdef bint is_quiet(self, bint is_following)
