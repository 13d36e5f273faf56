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
    cdef double[::1] q, links, flange, tool
    cdef Py_ssize_t end

cdef class ToolJacobianSource(ModelSource):
    cdef ToolPoseSource source
    cdef double[::1] pose

cdef class CoriolisSource(ModelSource):
    cdef ArmDynamics dynamics
    cdef object state, put_load
    cdef double[::1] q, dq, center, inertia, load
    cdef double mass
    cdef long changes
    @cython.locals(mass=double, differs=bint)
    cpdef bint is_another_load(self) except -1
