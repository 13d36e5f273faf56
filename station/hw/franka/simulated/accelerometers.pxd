from station.core.franka.joint_memory cimport JointMemory
from station.core.numerics.arm_chain cimport measure_accelerations, place_links

cdef class Accelerometers:
    cdef object state
    cdef tuple readings
    cdef JointMemory memory
    cdef double[::1] gravity, chain, links, top, bottom, top_readings, bottom_readings
    cdef double[::1] last, ddq
    cdef bint has_read
    cdef double seen
