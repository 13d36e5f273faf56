from station.controllers.cartesian_motion.pose_motion cimport PoseMotion
from station.controllers.smoothed_motion.motion_generator cimport MotionGenerator

cdef class CartesianMotionGenerator:
    cdef MotionGenerator _generator
    cdef readonly object pose, twist, accelerations
    cdef object _target, _wanted
    cdef readonly PoseMotion motion
    cdef tuple _last
    cpdef go_to(self, object pose)
    cpdef go_at(self, list twist)
    cpdef bint is_still(self)
    cpdef brake(self)
    cpdef bint is_at_rest(self)
    cpdef bint stays_within_speed(self)
    cpdef advance(self, double period)
    cpdef undo(self)
