cimport cython

cdef long long _PER_SECOND

@cython.locals(seconds=cython.longlong, rest=cython.longlong)
cpdef double uptime_seconds(long long nanoseconds)
