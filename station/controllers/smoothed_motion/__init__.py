"""Joint motion that is smooth within limits of velocity, acceleration and jerk.

A `JointStreamingController` follows positions that arrive 10 to 100 times a second; a
`JointJogController` moves joints while a button is held.
"""

from station.controllers.smoothed_motion.smoothed_motion_controller import (
    EffortJointJogController as EffortJointJogController,
    EffortJointStreamingController as EffortJointStreamingController,
    JointJogController as JointJogController,
    JointStreamingController as JointStreamingController,
    PositionJointJogController as PositionJointJogController,
    PositionJointStreamingController as PositionJointStreamingController,
)
