from station.memory.functions cimport square_root

cpdef void resting_ways(
    double[::1] velocities,
    double[::1] accelerations,
    double[::1] largest,
    double[::1] jerks,
    double[::1] ways,
) noexcept
cpdef void braking_peaks(
    double[::1] velocities,
    double[::1] accelerations,
    double[::1] largest,
    double[::1] jerks,
    double[::1] peaks,
) noexcept
cpdef double peak_speed(
    double[::1] velocities, double[::1] accelerations, double[::1] jerks
) noexcept
