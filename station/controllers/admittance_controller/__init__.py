"""Let arms give way to forces, in front of the controllers of their joints."""

from station.controllers.admittance_controller.admittance_controller import (
    AdmittanceController as AdmittanceController,
)
