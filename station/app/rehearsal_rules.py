"""The rules of rehearsals as the configuration has them."""

from station.config import StationConfig
from station.rehearsal.certificates import Tolerances
from station.rehearsal.envelope import Envelope
from station.rehearsal.rehearsals import Policy, Rules


def rules_of(config: StationConfig) -> Rules:
    """Return the rules of a station."""
    section, bounds = config.rehearsal, config.agents.envelope
    return Rules(
        operator=Policy(section.operator),
        agent=Policy(section.agent),
        envelope=Envelope(bounds.joints, bounds.speed, bounds.force),
        tolerances=Tolerances(section.pose_tolerance, section.tube),
    )
