cpdef double square_root(double value) noexcept
cpdef double sine(double angle) noexcept
cpdef double cosine(double angle) noexcept
cpdef double arctangent(double y, double x) noexcept
cpdef double exponential(double value) noexcept
