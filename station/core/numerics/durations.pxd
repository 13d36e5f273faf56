cdef class DurationRing:
    cdef readonly double[::1] values
    cdef readonly Py_ssize_t capacity
    cdef Py_ssize_t place
    cdef readonly long long added, count
    cdef readonly double largest, total, squares
    cpdef add(self, double duration)

cdef class CycleTimes:
    cdef readonly double[::1] rows
    cdef Py_ssize_t size, at
    cdef readonly long long count
    cdef readonly double longest_read, longest_update, longest_write, longest_total
    cdef public double last
    cpdef add(self, double begun, double read, double updated, double written)
