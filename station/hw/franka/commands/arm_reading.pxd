from station.hw.franka.commands.command_sender cimport CommandSender
from station.memory.vectors cimport FiniteCheck

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
