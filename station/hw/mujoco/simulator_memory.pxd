cdef class SimulatorMemory:
    cdef readonly Py_ssize_t size
    cdef readonly double[::1] positions, velocities, motor_forces, brake_forces, bias
    cdef readonly double[::1] compensation, constraint_forces, inertia, controls, limits
    cdef readonly double[::1] passive_damping, armature, applied
    cdef readonly long[::1] diagonal
