cimport cython
from station.hw.franka.commands.command_sender cimport CommandSender
from station.memory.finite_check cimport FiniteCheck

cdef int _MOVE

cdef class ArmReading:
    cdef object arm, read_once, motion
    cdef double[::1] joint_readings
    cdef FiniteCheck readings
    cdef CommandSender sender
    cdef double cycle_time
    cdef long most_lost, losses_that_end, bad
    cdef public object read_fingers
    cdef readonly double time_due
    cdef public long nominal
    cpdef read(self, double time, double period)

cdef class ArmWriting:
    cdef CommandSender sender
    cdef object hand, write_fingers
    cdef dict claimed
    cpdef write(self, double time, double period)

cdef class ArmWatch:
    cdef double[::1] code
    cdef dict names
    cdef CommandSender sender
    cdef double last_code
    cdef str last_name
    cpdef bint is_interrupted(self)
    @cython.locals(code=double)
    cpdef mode(self)
