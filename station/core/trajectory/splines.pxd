cpdef bint sample_splines(double[::1] splines, double time, double[::1] states) noexcept
