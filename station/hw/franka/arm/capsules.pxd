from station.core.geometry.distances cimport nearest_points, place_segments

cdef class LinkDistances:
    cdef double[::1] capsules, segments, point, normal
    cdef long[::1] owners, pairs
    cdef readonly long closest
    cpdef double measure(self, double[::1] links)
