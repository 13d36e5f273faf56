cimport cython
from station.memory.vectors cimport are_within

ctypedef void (*_OfTwo)(void*, void*) noexcept

cdef inline void call_with_two(size_t function, size_t first, size_t second) noexcept:
    (<_OfTwo> function)(<void*> first, <void*> second)

cdef class Preparation:
    cpdef prepare_step(self)

cdef class SpeedCheck:
    cdef double[::1] velocities, shares
    cdef readonly Py_ssize_t size
    cdef double slowest
    cpdef bint holds(self)

cdef class WorldStep:
    cdef object step, brake, count_pushes
    cdef size_t function, model, data
    cdef SpeedCheck speeds
    cdef readonly long long count
    cdef readonly list preparations
    cdef public bint stands_still, is_pushed, is_braked
    @cython.locals(one=Preparation)
    cpdef make_step(self)
