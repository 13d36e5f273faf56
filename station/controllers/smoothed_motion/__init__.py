"""Joint motion that is smooth within limits of velocity, acceleration and jerk.

A `JointStreamingController` follows positions that arrive 10 to 100 times a second; a
`JointJogController` moves joints while a button is held.
"""

from station.controllers.smoothed_motion.joint_jog_controller import (
    EffortJointJogController as EffortJointJogController,
    JointJogController as JointJogController,
    PositionJointJogController as PositionJointJogController,
)
from station.controllers.smoothed_motion.joint_streaming_controller import (
    EffortJointStreamingController as EffortJointStreamingController,
    JointStreamingController as JointStreamingController,
    PositionJointStreamingController as PositionJointStreamingController,
)
