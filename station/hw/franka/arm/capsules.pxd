cimport cython
from station.core.geometry.distances cimport nearest_points, place_segments

@cython.locals(point=double[::1], normal=double[::1])
cpdef long nearest_pair(
    double[::1] capsules, double[::1] segments, long[::1] pairs, double[::1] found
) noexcept

cdef class LinkDistances:
    cdef double[::1] capsules, segments, found
    cdef long[::1] owners, pairs
    cdef readonly long closest
    cpdef double measure(self, double[::1] links)
