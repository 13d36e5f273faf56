from station.core.numerics.rigid_motion cimport displace, twist_between
from station.memory.vectors cimport copy_into, differ

cdef Py_ssize_t _POSE, _ELBOW, _KEPT

cdef class PoseBridge:
    cdef double period
    cdef readonly double[::1] poses
    cdef double[::1] elbows
    cdef readonly Py_ssize_t newest
    cdef readonly long long cycle
    cdef readonly long long last_cycle
    cdef readonly long long earlier_cycle
    cdef readonly long long before_cycle
    cdef readonly bint is_on_commands
    cdef readonly double[::1] pose
    cdef readonly double[::1] elbow
    cdef list _step
    cdef list _bend
    cdef list _offset
    cdef list _rate
    cdef list _rise
    cdef double _gain
    cpdef bint is_expected(self) noexcept
    cpdef void note_next(self, double[::1] pose, double[::1] elbow) noexcept
    cpdef bint repeats(self, double[::1] pose) noexcept
    cpdef pass_on(self, double[::1] pose, double[::1] elbow)
    cpdef predict(self)
