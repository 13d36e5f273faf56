from station.core.numerics.arm_chain cimport place_links, twist_of, zero_jacobian
from station.core.numerics.rigid_motion cimport compose

cdef class EndEffectorState:
    cdef double extension
    cdef double[::1] chain, links, flange, jacobian, q, q_d, dq_d, ddq_d, tool, pose
    cdef double[::1] pose_d, pose_c, twist_d, twist_c, rate_c, elbow, elbow_d, elbow_c
    cdef double[::1] delbow_c, ddelbow_c
    cpdef void refresh(self) noexcept
    cpdef void command_desired(self) noexcept
    cpdef void command_joint_motion(self) noexcept

cpdef void bend(double[::1] q, double extension, double[::1] result) noexcept
