cimport cython
from station.core.numerics.arm_chain cimport place_links, twist_of, zero_jacobian
from station.memory.functions cimport square_root
from station.core.franka.joint_memory cimport JointMemory
from station.core.numerics.rigid_motion cimport compose, rotation_between

cdef double _CERTAIN

cdef class JointWatch:
    cdef readonly Py_ssize_t size
    cdef JointMemory memory
    cdef double[::1] chain
    cdef double[::1] tool
    cdef double[::1] links
    cdef double[::1] flange
    cdef double[::1] pose
    cdef double[::1] desired
    cdef double[::1] jacobian
    cdef double[::1] twist
    cdef double[::1] lower
    cdef double[::1] upper
    cdef double[::1] velocity
    cdef double[::1] torque
    cdef double reach
    cdef double reach_in_a_cycle
    cdef double speed
    cdef double power
    cdef double translation
    cdef double rotation
    cdef double elbow
    cdef public double room
    cdef readonly double total_power
    @cython.locals(i=Py_ssize_t, position=double, speed=double, torque=double, total=double, power=double, away=double, is_good=bint, is_slow=bint, is_close=bint)
    cpdef bint is_quiet(self, bint is_following)
    cdef bint is_slow(self)
    @cython.locals(i=Py_ssize_t)
    cdef bint is_close(self)
    cdef void place(self, double[::1] q, double[::1] pose) noexcept

@cython.locals(x=double, y=double, z=double)
cdef double _length(double[::1] vector) noexcept
