cimport cython
from station.core.numerics.arm_chain cimport turn_to_inner_axes, twist_of
from station.memory.vectors cimport copy_into
from station.core.franka.model_sources cimport ModelSource
from station.core.numerics.rigid_motion cimport numbers_of
from station.core.control.sample_columns cimport SampleColumns
from station.core.ports.set_point cimport SetPointPort

cdef Py_ssize_t _POSE, _QUATERNION, _TWIST

cdef class EndEffectorSample:
    cdef Py_ssize_t size
    cdef readonly double[::1] desired
    cdef readonly double[::1] actual
    cdef readonly double[::1] errors
    cdef readonly SampleColumns sampled
    cpdef measure(self)
    @cython.locals(i=Py_ssize_t)
    cpdef keep(self, double time)

cdef class PoseSample(EndEffectorSample):
    cdef double[::1] pose
    cdef ModelSource source
    cdef readonly double[::1] near
    cdef double[::1] actual_pose
    cdef double[::1] quaternion
    cpdef measure(self)

cdef class TwistSample(EndEffectorSample):
    cdef double[::1] pose
    cdef double[::1] twist
    cdef ModelSource measured_pose
    cdef ModelSource source
    cdef double[::1] dq
    cdef public bint is_inner
    cdef double[::1] actual_pose
    cdef double[::1] jacobian
    cpdef measure(self)

cdef class EndEffectorUpdate:
    cdef SetPointPort port
    cdef object move
    cdef EndEffectorSample sample
    cdef public bint is_resting
    cpdef move_end_effector(self, double time, double period)
