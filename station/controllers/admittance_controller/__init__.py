"""Let arms give way to forces, in front of what controls their joints."""

from station.controllers.admittance_controller.admittance_controller import (
    AdmittanceController as AdmittanceController,
)
