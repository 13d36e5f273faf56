from station.memory.vectors cimport any_of, copy_into
from station.core.franka.joint_memory cimport JointMemory

cdef class DesiredMotion:
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef double[::1] lower, upper, largest_step, wanted
    cdef double period
    cdef readonly bint rests
    cpdef bint is_at_rest(self)
    cpdef hold(self)
    cpdef extrapolate(self)
    cpdef follow_velocities(self)
    cpdef move(self)
    cpdef follow_positions(self)
