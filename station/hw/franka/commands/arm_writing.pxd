cimport cython
from station.hw.franka.commands.command_sender cimport CommandSender
from station.hw.franka.arm.flags cimport MotionFlags
from station.core.hardware.stages cimport RobotWatch, Stage

cdef int _MOVE

cdef class ArmWatch(RobotWatch):
    cdef double[::1] code
    cdef dict names
    cdef MotionFlags motion
    cdef double last_code
    cdef str last_name
    cpdef bint is_interrupted(self)
    @cython.locals(code=double)
    cpdef mode(self)

cdef class ArmWriting(Stage):
    cdef CommandSender sender
    cdef object write_fingers
    cdef object claimed
    cdef object hand
    cpdef run(self, double time, double period)
