cdef class Violations:
    cdef public Py_ssize_t count
    cdef double[::1] rows
    cpdef void add(self, int code, Py_ssize_t part, double value, double bound)
