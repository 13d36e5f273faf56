from station.kernel.at_once cimport copy_into
from station.kernel.model_sources cimport ModelSource
from station.kernel.rigid_motion cimport numbers_of
from station.kernel.sample_columns cimport SampleColumns
from station.kernel.set_points cimport SetPointNews
from station.kernel.usual_update cimport UsualUpdate

cdef Py_ssize_t _NUMBERS, _QUATERNION

cdef class PoseSample:
    cdef double[::1] pose
    cdef ModelSource source
    cdef readonly double[::1] near
    cdef double[::1] actual_pose
    cdef readonly double[::1] desired
    cdef double[::1] quaternion
    cdef readonly double[::1] actual
    cdef readonly double[::1] errors
    cdef readonly SampleColumns sampled
    cpdef keep(self, double time)

cdef class RestingPose(UsualUpdate):
    cdef SetPointNews news
    cdef PoseSample sample
    cdef public bint is_resting
    cpdef bint run(self, double time, double period) except -1
