cdef class JointMemory:
    cdef readonly Py_ssize_t size
    cdef readonly double[::1] q
    cdef readonly double[::1] dq
    cdef readonly double[::1] positions
    cdef readonly double[::1] dtheta
    cdef readonly double[::1] tau_J
    cdef readonly double[::1] dtau_J
    cdef readonly double[::1] q_d
    cdef readonly double[::1] dq_d
    cdef readonly double[::1] ddq_d
    cdef readonly double[::1] tau_J_d
    cdef readonly double[::1] last_tau_J
    cdef readonly double[::1] target
    cdef readonly double[::1] target_dq
    cdef readonly double[::1] torques
    cdef readonly double[::1] sent
