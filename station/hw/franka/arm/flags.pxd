cdef class MotionFlags:
    cdef public bint is_active
    cdef public bint is_waiting

cdef class ContactFlag:
    cdef public bint is_quiet

cdef class AlertFlag:
    cdef public bint is_alert
