from station.kernel.command_sending cimport CommandSending
from station.kernel.stages cimport RobotWatch, Stage

cdef int _MOVE

cdef class ArmWatch(RobotWatch):
    cdef double[::1] code
    cdef dict names
    cdef object motion
    cpdef bint is_interrupted(self)
    cpdef mode(self)

cdef class ArmWriting(Stage):
    cdef double[::1] code
    cdef CommandSending sender
    cdef public object fingers
    cpdef run(self, double time, double period)
