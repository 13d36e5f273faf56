cimport cython
from station.core.control.command_pieces cimport CommandPieces, Piece
from station.core.numerics.durations cimport Durations
from station.core.control.records cimport Records
from station.core.control.sample_columns cimport SampleColumns
from station.core.hardware.stages cimport RobotWatch, Stage
from station.core.control.usual_update cimport UsualUpdate
from station.memory.wall_time cimport wall_time

cdef double _INF

cdef class OwnerFlags:
    cdef public bint is_stale
    cdef public long traced_cycles

cdef class ControllerTurn:
    cdef object one
    cdef object controller
    cdef object name
    cdef Durations durations
    cdef list pieces
    cdef UsualUpdate usual
    cdef SampleColumns sampled
    cdef Py_ssize_t place

cdef class ControllerRound(Stage):
    cdef readonly OwnerFlags gate
    cdef RobotWatch watch
    cdef object running
    cdef tuple contained
    cdef readonly list turns
    cdef tuple layout
    cdef Records records
    cdef public CommandPieces kept
    cdef public double update_budget
    cdef public long long cycle
    cdef public double time
    cdef public long thread
    cdef public bint updating
    cdef public object pending
    cdef public bint resets
    cdef public object stopwatch
    cpdef run(self, double time, double period)
    @cython.locals(turn=ControllerTurn)
    cpdef update_all(self, double time, double period)
    @cython.locals(begin=double, duration=double, is_finite=bint, piece=Piece)
    cpdef update_one(self, ControllerTurn turn, double time, double period)
    cpdef leave_in(self, Records records)
    @cython.locals(turn=ControllerTurn, sampled=SampleColumns, at=Py_ssize_t, room=Py_ssize_t, width=Py_ssize_t, size=Py_ssize_t)
    cpdef take_turns(self, list turns)
    @cython.locals(turn=ControllerTurn, sampled=SampleColumns, records=Records, at=Py_ssize_t, is_running=bint)
    cpdef leave(self, long long cycle, long long epoch, double time, double period)
