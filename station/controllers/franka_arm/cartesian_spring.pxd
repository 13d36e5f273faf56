cimport cython
from station.core.franka.model_sources cimport ModelSource
from station.core.numerics.arm_chain cimport WrenchEquation, torques_of, twist_of
from station.core.numerics.command_rates cimport filter_commands
from station.core.numerics.rigid_motion cimport quaternion_of
from station.core.ports.set_point cimport SetPointPort
from station.core.toolbox.publish_timer cimport PublishTimer
from station.memory.functions cimport arctangent, sine, square_root
from station.memory.vectors cimport copy_into

cdef double _FILTER, _INVERSE_DAMPING, _CLOSE

cdef class PoseSpring:
    cdef readonly Py_ssize_t size
    cdef bint is_angle
    cdef double largest_step
    cdef double[::1] q, dq, last_torques, damping, stray, twist, wrench, quaternion
    cdef readonly double[::1] pose, jacobian, coriolis, torques, equilibrium, target
    cdef readonly double[::1] stiffness, wanted, error, rest
    cdef WrenchEquation equation
    cpdef void compute_torques(self) noexcept
    cpdef void balance_error(self) noexcept
    cpdef void approach_targets(self) noexcept

cdef class CartesianSpring:
    cdef readonly PoseSpring spring
    cdef ModelSource _pose, _jacobian, _coriolis
    cdef object _copies
    cdef double[::1] _commands
    cpdef command_torques(self)

cdef class SpringUpdate:
    cdef SetPointPort port
    cdef object retarget
    cdef list springs
    cdef PublishTimer timer
    cdef readonly object published
    @cython.locals(spring=CartesianSpring)
    cpdef command_springs(self, double time)
