cdef class StopFlag:
    cdef public bint pending

cdef class OwnerFlags:
    cdef public bint is_stale
    cdef public long traced_cycles

cdef class MotionFlags:
    cdef public bint is_active
    cdef public bint is_waiting

cdef class ContactFlag:
    cdef public bint is_quiet

cdef class AlertFlag:
    cdef public bint is_alert
