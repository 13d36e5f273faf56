cdef class JointMemory:
    cdef readonly Py_ssize_t size
    cdef readonly double[::1] q, dq, positions, dtheta, tau_J, dtau_J, q_d, dq_d, ddq_d
    cdef readonly double[::1] tau_J_d, last_tau_J, target, target_dq, torques, sent
