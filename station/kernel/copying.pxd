cimport cython

@cython.locals(i=Py_ssize_t)
cpdef void copy_into(
    double[::1] target, Py_ssize_t start, double[::1] source, Py_ssize_t size
) noexcept
