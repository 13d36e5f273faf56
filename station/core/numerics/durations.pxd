cimport cython

cdef class Durations:
    cdef readonly Py_ssize_t capacity
    cdef readonly double[::1] values
    cdef Py_ssize_t place
    cdef readonly long long count
    cdef readonly double largest
    cdef readonly double total
    cdef readonly double squares
    cpdef add(self, double duration)
    cdef void put(self, double duration) noexcept
    cpdef reset(self)

cdef class CycleTimes:
    cdef readonly double[::1] rows
    cdef Py_ssize_t size
    cdef Py_ssize_t at
    cdef readonly long long count
    cdef readonly double longest_read
    cdef readonly double longest_update
    cdef readonly double longest_write
    cdef readonly double longest_total
    cdef public double last
    @cython.locals(at=Py_ssize_t, update=double, write=double, total=double)
    cpdef add(self, double begun, double read, double updated, double written)
    cpdef reset(self)
