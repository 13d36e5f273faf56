from station.memory.vectors cimport are_finite, copy_into, differ
cimport cython

cdef class Piece:
    cpdef bint take(self)
    cpdef bint differs(self)
    cpdef write(self)

cdef class CommandPiece(Piece):
    cdef readonly object slots
    cdef readonly double[::1] memory
    cdef readonly double[::1] values
    cdef readonly Py_ssize_t size
    cpdef bint take(self)
    cpdef bint differs(self)
    cpdef write(self)

cdef class CommandPieces:
    cdef list pieces
    cdef object report
    cdef Py_ssize_t next
    @cython.locals(place=Py_ssize_t, piece=Piece, one=Piece)
    cpdef keep(self)
