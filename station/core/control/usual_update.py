"""The update of a controller in a usual cycle, in one call."""


class UsualUpdate:
    """Does the same as a controller's `update`, as long as nothing unusual happens."""

    def run(self, time: float, period: float) -> bool:
        """Do it, or nothing at all.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.

        Returns:
            Whether it was done; if not, the controller's `update` has to do it.
        """
        raise NotImplementedError
