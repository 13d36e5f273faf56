cimport cython
from station.core.numerics.arm_chain cimport zero_jacobian
from station.core.numerics.arm_dynamics cimport ArmDynamics
from station.memory.vectors cimport copy_into
from station.core.numerics.rigid_motion cimport compose

cdef class ModelSource:
    cdef object function
    cpdef write(self, double[::1] result)

cdef class ToolPoseSource(ModelSource):
    cdef ArmDynamics dynamics
    cdef double[::1] q
    cdef double[::1] links
    cdef Py_ssize_t end
    cdef double[::1] flange
    cdef double[::1] tool
    cpdef write(self, double[::1] result)

cdef class ToolJacobianSource(ModelSource):
    cdef ToolPoseSource source
    cdef double[::1] pose
    cpdef write(self, double[::1] result)

cdef class CoriolisSource(ModelSource):
    cdef ArmDynamics dynamics
    cdef object state
    cdef double[::1] q
    cdef double[::1] dq
    cdef double[::1] center
    cdef double[::1] inertia
    cdef object put_load
    cdef double mass
    cdef double[::1] load
    cdef long changes
    cpdef write(self, double[::1] result)
    @cython.locals(mass=double, differs=bint, load=double[::1])
    cpdef bint is_another_load(self) except -1
