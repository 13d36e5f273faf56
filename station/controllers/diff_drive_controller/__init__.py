"""Drive a base by the wheels of its two sides, and estimate its pose."""

from station.controllers.diff_drive_controller.diff_drive_controller import (
    DiffDriveController as DiffDriveController,
)
