from station.hw.franka.arm.receiver cimport PoseReceiver
from station.memory.vectors cimport copy_into
from station.hw.franka.commands.pose_rates cimport PoseRates

cdef Py_ssize_t _POSE, _ELBOW, _KEPT

cdef class PassedPoses:
    cdef public long long cycle
    cdef public bint is_on_commands
    cdef readonly double[::1] poses
    cdef readonly double[::1] elbows
    cdef readonly long long last_cycle
    cdef readonly long long earlier_cycle
    cdef readonly long long before_cycle
    cdef readonly Py_ssize_t newest
    cpdef note(self, double[::1] pose, double[::1] elbow)
    cpdef bint repeats(self, double[::1] pose)
    cpdef bint pass_usual(self, double[::1] pose, double[::1] elbow)

cdef class PoseSend:
    cdef PassedPoses passed
    cdef double[::1] pose
    cdef double[::1] elbow
    cdef PoseRates rates
    cdef PoseReceiver receiver
    cdef public bint is_usual
    cpdef bint send(self)
