cimport cython

cdef class Stage:
    cpdef run(self, double time, double period)

cdef class RobotWatch:
    cdef object robot
    cpdef bint is_interrupted(self)
    cpdef mode(self)

cdef class RobotReading(Stage):
    cdef object robot
    cpdef run(self, double time, double period)

cdef class RobotWriting(Stage):
    cdef object robot
    cpdef run(self, double time, double period)

cdef class StageSequence(Stage):
    cdef list stages
    @cython.locals(stage=Stage)
    cpdef run(self, double time, double period)
