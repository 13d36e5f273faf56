cdef class SimulatorMemory:
    cdef readonly Py_ssize_t size
    cdef readonly double[::1] positions
    cdef readonly double[::1] velocities
    cdef readonly double[::1] motor_forces
    cdef readonly double[::1] brake_forces
    cdef readonly double[::1] bias
    cdef readonly double[::1] compensation
    cdef readonly double[::1] constraint_forces
    cdef readonly double[::1] inertia
    cdef readonly double[::1] controls
    cdef readonly double[::1] limits
    cdef readonly double[::1] passive_damping
    cdef readonly double[::1] armature
    cdef readonly double[::1] applied
    cdef readonly long[::1] diagonal
