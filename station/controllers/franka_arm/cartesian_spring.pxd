cimport cython
from station.controllers.franka_arm.pose_spring cimport PoseSpring
from station.core.franka.model_sources cimport ModelSource
from station.core.ports.set_point cimport SetPointPort
from station.core.toolbox.publish_timer cimport PublishTimer
from station.memory.vectors cimport copy_into

cdef class CartesianSpring:
    cdef readonly PoseSpring spring
    cdef ModelSource _pose, _jacobian, _coriolis
    cdef object _copies
    cdef double[::1] _commands
    cpdef command_torques(self)

cdef class SpringUpdate:
    cdef SetPointPort port
    cdef object retarget
    cdef list springs
    cdef PublishTimer timer
    cdef readonly object published
    @cython.locals(spring=CartesianSpring)
    cpdef command_springs(self, double time)
