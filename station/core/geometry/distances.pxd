cimport cython
from station.memory.functions cimport square_root

cdef int _SPHERE, _CAPSULE, _CYLINDER, _BOX, _HALF_SPACE
cdef double _PARALLEL, _EXACT

cdef class Nearness:
    cdef double[::1] solids, triangles
    cdef readonly double distance
    cdef readonly double[::1] point, normal
    cpdef double to_row(
        self, double[::1] ends, long i, double radius, long o) noexcept
    @cython.locals(kind=int, x=double, y=double, z=double)
    cpdef double of_row(self, double px, double py, double pz, long o) noexcept
    @cython.locals(begin=long, count=long)
    cpdef double of_mesh(self, double x, double y, double z, long o) noexcept

cdef double _clipped(double value) noexcept
cpdef double nearest_points(
    double[::1] first, double[::1] second, double[::1] point, double[::1] normal
) noexcept
cpdef void place_segments(
    double[::1] capsules, long[::1] owners, double[::1] links, double[::1] segments
) noexcept
