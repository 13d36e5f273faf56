cimport cython
from station.memory.functions cimport square_root

cdef int _ROW, _MARGIN, _SPHERE, _CAPSULE, _CYLINDER, _BOX, _HALF_SPACE
cdef double _PARALLEL, _EXACT

cdef class Nearness:
    cdef readonly double distance
    cdef readonly double[::1] point, normal
    cpdef double to_row(
        self, double[::1] ends, long i, double radius, double[::1] solids, long o,
        double[::1] triangles) noexcept
    @cython.locals(kind=int, x=double, y=double, z=double)
    cpdef double of_row(
        self, double px, double py, double pz, double[::1] solids, long o,
        double[::1] triangles) noexcept
    @cython.locals(begin=long, count=long)
    cpdef double of_mesh(
        self, double x, double y, double z, double[::1] solid, double[::1] triangles
    ) noexcept

cdef double _clipped(double value) noexcept
cpdef double nearest_points(
    double[::1] first, double[::1] second, double[::1] point, double[::1] normal
) noexcept
cpdef void place_segments(
    double[::1] capsules, long[::1] owners, double[::1] links, double[::1] segments
) noexcept
@cython.locals(x=double, y=double, z=double)
cpdef void put_capsule(
    double[::1] row, double[::1] place, double[::1] ends, double radius, double margin
) noexcept
