from station.controllers.cartesian_motion.cartesian_motion_generator cimport (
    CartesianMotionGenerator,
)
from station.controllers.cartesian_motion.linear_kinematics cimport LinearKinematics
from station.controllers.cartesian_motion.pose_motion cimport PoseMotion
from station.controllers.cartesian_motion.stop_prediction cimport StopPrediction
from station.core.franka.model_sources cimport ModelSource
from station.memory.vectors cimport copy_into

cdef Py_ssize_t _DOF

cdef class ArmConfiguration:
    cdef double[::1] _q
    cdef double[::1] _jacobian
    cdef ModelSource _pose_source
    cdef ModelSource _jacobian_source
    cdef readonly LinearKinematics motion

    cpdef move_to(self, double[::1] q)
    cpdef place(self, double[::1] pose)

cdef class JointLookahead:
    cdef object _model
    cdef object _joints
    cdef object _settings
    cdef object _pose
    cdef object _new
    cdef object _q_d
    cdef StopPrediction _prediction
    cdef readonly object obstacle
    cdef readonly object joint
    cdef ArmConfiguration _present
    cdef ArmConfiguration _resting
    cdef ArmConfiguration _other
    cdef double _dexterity
    cdef double _clearance

    cpdef bint passes(self, CartesianMotionGenerator motion) except -1
    cpdef bint allows(self, CartesianMotionGenerator motion) except -1
    cdef _obstacle_at(self, ArmConfiguration resting)
    cdef _speed_obstacle(self, LinearKinematics resting, PoseMotion motion)
