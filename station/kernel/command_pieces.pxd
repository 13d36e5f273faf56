cimport cython

cdef class CommandPiece:
    cdef readonly double[::1] memory
    cdef readonly double[::1] values
    cdef readonly Py_ssize_t size
    cpdef bint take(self)
    cpdef bint differs(self)
    cpdef write(self)

cdef class CommandPieces:
    cdef list pieces
    @cython.locals(piece=CommandPiece)
    cpdef write(self)
