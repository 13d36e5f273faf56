from station.memory.functions cimport square_root
from station.hw.mujoco.world_step cimport Preparation

cdef double _VELOCITY, _EFFORT
cdef double _VELOCITY_GAIN, _POSITION_GAIN, _SHARE_OF_EFFORT, _SHARE_OF_ACCELERATION

cpdef double approach_velocity(double error, double braking) noexcept

cdef class JointDrives(Preparation):
    cdef object _joints
    cdef readonly object velocity_limits, modes, targets
    cdef double[::1] qpos, qvel, bias, weight, inertia, control, damping
    cdef long long[::1] place_qpos, place_dof, place_inertia
    cdef long long[::1] place_control, place_damping
    cdef double[::1] mode, position, velocity, effort, velocity_limit, effort_limit
    cdef double[::1] lower_limit, upper_limit, desired
    cdef Py_ssize_t size
    cdef double timestep
