from station.controllers.cartesian_motion.cartesian_motion_generator cimport (
    CartesianMotionGenerator)
from station.controllers.cartesian_motion.end_effector_sample cimport EndEffectorSample
from station.controllers.cartesian_motion.joint_lookahead cimport JointLookahead
from station.core.ports.set_point cimport ActiveSetPoint
from station.memory.vectors cimport copy_into

cdef double _PUBLISHED_FOR
cdef Py_ssize_t _POSE
cdef object _NONE

cdef class EndEffectorUpdate:
    cdef ActiveSetPoint active
    cdef object steer
    cdef CartesianMotionGenerator generator
    cdef JointLookahead lookahead
    cdef EndEffectorSample sample
    cdef double[::1] pose, command
    cdef public bint is_resting
    cdef public object steered
    cdef readonly object obstacle, joint
    cdef double until
    cpdef move_end_effector(self, double time, double period)
    cdef advance(self, double time, double period)
    cdef note(self, object obstacle, object joint, double time)
