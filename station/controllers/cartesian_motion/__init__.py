"""Cartesian motion that is smooth within limits of velocity, acceleration and jerk.

`CartesianStreamingController` follows poses that arrive 10 to 100 times a second;
`CartesianJogController` moves an end effector while a button is held.
"""

from station.controllers.cartesian_motion.jog_and_streaming_controllers import (
    CartesianJogController as CartesianJogController,
    CartesianStreamingController as CartesianStreamingController,
)
