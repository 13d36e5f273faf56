cimport cython
from station.memory.vectors cimport copy_into
from station.core.control.sample_columns cimport SampleColumns

cdef Py_ssize_t _HEAD
cdef double _NAN

cdef class StatePiece:
    cdef double[::1] values
    cdef Py_ssize_t size

cdef class Records:
    cdef readonly Py_ssize_t capacity
    cdef readonly Py_ssize_t width
    cdef readonly Py_ssize_t states
    cdef readonly Py_ssize_t room
    cdef readonly long long newest
    cdef readonly object memory
    cdef readonly list modes
    cdef readonly list layouts
    cdef readonly list objects
    cdef list pieces
    cdef double[::1] rows
    @cython.locals(slot=Py_ssize_t, at=Py_ssize_t, piece=StatePiece)
    cpdef Py_ssize_t begin(
        self, long long cycle, long long epoch, double time, double period, object mode
    )
    cpdef add(self, Py_ssize_t at, SampleColumns sampled, bint is_there)
    @cython.locals(slot=Py_ssize_t)
    cpdef end(self, long long cycle, object layout, object objects)
