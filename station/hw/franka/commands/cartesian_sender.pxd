from station.core.numerics.command_rates cimport filter_commands, limited
from station.core.geometry.guard cimport Guard
from station.core.numerics.rigid_motion cimport displace, rotation_between, twist_between
from station.hw.franka.arm.receiver cimport Receiver
from station.memory.functions cimport square_root
from station.memory.vectors cimport copy_into, differ

cdef double _INF, _TINY
cdef int _SLOWED, _CARTESIAN
cdef Py_ssize_t _POSE, _ELBOW, _KEPT

cpdef void limit_vector(
    double[::1] vector, Py_ssize_t start, double[::1] last_velocity,
    double[::1] last_acceleration, double[::1] bounds, double share, double period
) noexcept

cpdef bint has_elbow(double[::1] elbow) noexcept

cdef class PoseRates:
    cdef double[::1] pose, twist, acceleration, elbow, elbow_velocity
    cdef double[::1] elbow_acceleration, translation, rotation, elbow_limits, way
    cdef double pose_share, period
    cdef public double gain
    cdef public bint is_limiting
    cdef readonly double[::1] sent_pose, sent_twist, sent_elbow
    cpdef void filter_pose(self, double[::1] pose, bint passes) noexcept
    cpdef void filter_twist(self, double[::1] twist) noexcept
    cpdef void filter_elbow(self, double[::1] elbow, bint passes) noexcept
    cpdef void limit(self, double[::1] twist, double rotation_share) noexcept

cdef class PoseBridge:
    cdef double period, _gain
    cdef double[::1] elbows
    cdef readonly double[::1] poses, pose, elbow
    cdef readonly Py_ssize_t newest
    cdef readonly long long cycle, last_cycle, earlier_cycle, before_cycle
    cdef readonly bint is_on_commands
    cdef list _step, _bend, _offset, _rate, _rise
    cpdef bint is_expected(self) noexcept
    cpdef void note_next(self, double[::1] pose, double[::1] elbow) noexcept
    cpdef bint repeats(self, double[::1] pose) noexcept

cdef class CartesianSender:
    cdef object arm
    cdef Receiver receiver
    cdef PoseRates rates
    cdef PoseBridge bridge
    cdef double[::1] pose, twist, pose_elbow, twist_elbow
    cdef bint filters_first, is_first
    cdef public Guard guard
    cpdef send_pose(self, bint is_new)
    cpdef send_twist(self)
