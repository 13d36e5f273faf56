cimport cython
from station.core.geometry.distances cimport Nearness, place_segments
from station.core.numerics.arm_chain cimport place_links, place_tree
from station.memory.functions cimport square_root

cdef long _ROW, _MARGIN, _MOST_STEPS, _REFINEMENTS
cdef double _FAR, _STEP, _ROUNDING

cdef class Clearances:
    cdef double[::1] at, last, moved, extents, shifts, tree
    cdef readonly double[::1] chain, reach
    cdef readonly double[::1] capsules, links, segments, solids, way, gaps
    cdef long[::1] allowed, parents
    cdef readonly long[::1] owners, joints
    cdef long size, link_count
    cdef bint is_tree
    cdef readonly long count, solid_count, pair, blocking
    cdef readonly double distance, least, horizon
    cdef public double slack, lag
    cdef public long most_steps
    cdef readonly Nearness nearness
    @cython.locals(row=double[::1], x=double, y=double, z=double)
    cpdef put_capsule(
        self, long solid, double[::1] place, double[::1] ends, double radius,
        double margin)
    cdef void place(self, double[::1] q, double share) noexcept
    cdef double bound(self, long capsule, long solid) noexcept
    cdef double exact(self, long capsule, long solid) noexcept
    cdef void note_motion(self, double[::1] q) noexcept
    cdef double add_up(self, double[::1] steps, double first) noexcept
    cpdef double measure(self, double[::1] q, double horizon) noexcept
    cdef long blocked_at(self, double[::1] q, double share) noexcept
    @cython.locals(steps=long)
    cpdef double free_share(self, double[::1] q, double zone) noexcept
