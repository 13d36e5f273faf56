from station.core.numerics.rigid_motion cimport displace, twist_between
from station.memory.vectors cimport copy_into, differ

cdef Py_ssize_t _POSE, _ELBOW, _KEPT

cdef class PoseBridge:
    cdef double period, _gain
    cdef readonly double[::1] poses, pose, elbow
    cdef double[::1] elbows
    cdef readonly Py_ssize_t newest
    cdef readonly long long cycle, last_cycle, earlier_cycle, before_cycle
    cdef readonly bint is_on_commands
    cdef list _step, _bend, _offset, _rate, _rise
    cpdef bint is_expected(self) noexcept
    cpdef void note_next(self, double[::1] pose, double[::1] elbow) noexcept
    cpdef bint repeats(self, double[::1] pose) noexcept
    cpdef pass_on(self, double[::1] pose, double[::1] elbow)
    cpdef predict(self)
