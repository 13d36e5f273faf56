cdef long long _PER_SECOND

cpdef double uptime_seconds(long long nanoseconds)
