"""How fast the time of a trajectory passes: pause, resume and everything between."""


class SpeedScaling:
    """A factor between 0 and 1 that changes at a limited rate.

    Args:
        target: First factor, also its present value.
        ramp_time: Time from standstill to full speed [s], >= 0.

    Attributes:
        target: The factor that is wanted, 0 to 1.
        factor: The present factor, 0 to 1.
        rate: Present change of the factor [1/s].
    """

    def __init__(self, target: float = 1.0, ramp_time: float = 0.5) -> None:
        self.target = target
        self.factor = target
        self.rate = 0.0
        self._ramp_time = ramp_time

    def advance(self, period: float) -> float:
        """Move the factor towards its target and return how much time passes [s].

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        if self.factor == self.target:
            self.rate = 0.0
            return period * self.factor
        before = self.factor
        step = period / self._ramp_time if self._ramp_time > 0.0 else 1.0
        difference = self.target - before
        if abs(difference) <= step:
            self.factor = self.target
        else:
            self.factor = before + (step if difference > 0.0 else -step)
        self.rate = (self.factor - before) / period if period > 0.0 else 0.0
        return period * 0.5 * (before + self.factor)
