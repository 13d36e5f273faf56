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
    cdef Durations read
    cdef Durations update
    cdef Durations write
    cdef Durations total
    cdef public double last
    cpdef add(self, double begun, double read, double updated, double written)
