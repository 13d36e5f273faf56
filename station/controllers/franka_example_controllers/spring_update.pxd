cimport cython
from station.memory.vectors cimport copy_into
from station.core.franka.model_sources cimport ModelSource
from station.controllers.franka_example_controllers.pose_spring cimport PoseSpring
from station.core.toolbox.publish_timer cimport PublishTimer
from station.core.ports.set_point cimport SetPointPort
from station.core.control.usual_update cimport UsualUpdate

cdef class DrivenSpring:
    cdef PoseSpring spring
    cdef ModelSource pose
    cdef ModelSource jacobian
    cdef ModelSource coriolis
    cdef double[::1] commands
    @cython.locals(spring=PoseSpring)
    cpdef drive(self)

cdef class SpringUpdate(UsualUpdate):
    cdef SetPointPort port
    cdef list springs
    cdef PublishTimer timer
    cdef readonly object published
    cpdef bint run(self, double time, double period) except -1
    @cython.locals(spring=DrivenSpring, first=DrivenSpring, pose=double[::1])
    cpdef follow(self, double time)
