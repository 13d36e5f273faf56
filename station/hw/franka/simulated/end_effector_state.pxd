from station.core.numerics.arm_chain cimport place_links, twist_of, zero_jacobian
from station.core.numerics.rigid_motion cimport compose

cdef class EndEffectorState:
    cdef double extension
    cdef double[::1] chain
    cdef double[::1] links
    cdef double[::1] flange
    cdef double[::1] jacobian
    cdef double[::1] q
    cdef double[::1] q_d
    cdef double[::1] dq_d
    cdef double[::1] ddq_d
    cdef double[::1] tool
    cdef double[::1] pose
    cdef double[::1] pose_d
    cdef double[::1] pose_c
    cdef double[::1] twist_d
    cdef double[::1] twist_c
    cdef double[::1] rate_c
    cdef double[::1] elbow
    cdef double[::1] elbow_d
    cdef double[::1] elbow_c
    cdef double[::1] delbow_c
    cdef double[::1] ddelbow_c

    cpdef void refresh(self) noexcept
    cpdef void command_desired(self) noexcept
    cpdef void command_joint_motion(self) noexcept

cpdef void bend(double[::1] q, double extension, double[::1] result) noexcept
