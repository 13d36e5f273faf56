from station.core.numerics.arm_chain cimport turn_to_inner_axes, twist_of
from station.memory.vectors cimport copy_into
from station.core.franka.model_sources cimport ModelSource
from station.core.numerics.rigid_motion cimport numbers_of
from station.core.control.sample_columns cimport SampleColumns

cdef Py_ssize_t _POSE, _QUATERNION, _TWIST

cdef class EndEffectorSample:
    cdef Py_ssize_t size
    cdef readonly double[::1] desired, actual, errors
    cdef readonly SampleColumns sampled
    cpdef measure(self)
    cpdef keep(self, double time)

cdef class PoseSample(EndEffectorSample):
    cdef double[::1] pose, actual_pose, quaternion
    cdef ModelSource source
    cdef readonly double[::1] near

cdef class TwistSample(EndEffectorSample):
    cdef double[::1] pose, twist, dq, actual_pose, jacobian
    cdef ModelSource measured_pose, source
    cdef public bint is_inner
