"""Drive a base by its two sides of wheels, and tell where it is."""

from station.controllers.diff_drive_controller.diff_drive_controller import (
    DiffDriveController as DiffDriveController,
)
