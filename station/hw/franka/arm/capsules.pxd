cimport cython

from station.memory.functions cimport square_root

cdef double _PARALLEL

cpdef void place_segments(
    double[::1] capsules, long[::1] owners, double[::1] links, double[::1] segments
) noexcept
@cython.locals(best=double)
cpdef long nearest_pair(
    double[::1] capsules, double[::1] segments, long[::1] pairs, double[::1] found
) noexcept
cpdef double segment_distance(double[::1] first, double[::1] second) noexcept

cdef class LinkDistances:
    cdef double[::1] capsules, segments, found
    cdef long[::1] owners, pairs
    cdef readonly long closest
    @cython.locals(number=long, first=long, second=long)
    cpdef double measure(self, double[::1] links)
