"""Motion that is smoothed within limits of velocity, acceleration and jerk.

`JointStreamingController` follows positions that arrive 10 to 100 times a second,
`JointJogController` moves joints while somebody holds a button. One module per package
of command interface.
"""

from station.controllers.smoothed_motion.jog import JointJogControllerBase
from station.controllers.smoothed_motion.streaming import JointStreamingControllerBase

__all__ = ["JointJogControllerBase", "JointStreamingControllerBase"]
