from station.controllers.cartesian_motion.cartesian_motion_generator cimport PoseMotion
from station.controllers.cartesian_motion.linear_kinematics cimport (
    LinearKinematics, StopPrediction)
from station.core.franka.model_sources cimport ModelSource
from station.memory.vectors cimport copy_into

cdef Py_ssize_t _DOF
cdef object _NONE

cdef class ArmConfiguration:
    cdef double[::1] _q, _jacobian
    cdef ModelSource _pose_source, _jacobian_source
    cdef readonly LinearKinematics motion
    cpdef move_to(self, double[::1] q)
    cpdef place(self, double[::1] pose)

cdef class JointLookahead:
    cdef object _model, _joints, _settings, _pose, _new, _q_d
    cdef StopPrediction _prediction
    cdef readonly object obstacle, joint
    cdef ArmConfiguration _present, _resting, _other
    cdef double _dexterity, _clearance
    cpdef bint passes(self, PoseMotion motion) except -1
    cpdef bint allows(self, PoseMotion motion) except -1
    cdef _obstacle_at(self, ArmConfiguration resting)
    cdef _speed_obstacle(self, LinearKinematics resting, PoseMotion motion)
