cpdef double wall_time()
