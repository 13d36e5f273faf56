cdef object _WORKING, _FINISHED

cdef class MotionGenerator:
    cdef public list positions, velocities, accelerations
    cdef public bint is_still
    cdef Py_ssize_t _size
    cdef list _held, _wanted
    cdef bint _goes_to_positions
    cdef double _period
    cdef object _ruckig, _input, _output, _braking, _trajectory
    cpdef tuple state(self)
    cpdef relocate(self, list positions)
    cpdef go_to(self, list positions)
    cpdef advance(self, double period)
