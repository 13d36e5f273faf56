"""Bases that drive by the velocities of their left and right wheels."""

from station.controllers.diff_drive_controller.diff_drive_controller import (
    DiffDriveController as DiffDriveController,
)
