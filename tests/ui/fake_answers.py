"""What the fake station answers with."""

from dataclasses import dataclass, field

from starlette.responses import JSONResponse

JOINTS = [f"panda_joint{i}" for i in range(1, 8)]
NO_TIMES = {"p50": 0.0, "p99": 1.2e-4, "p999": 2e-4, "max": 1e-3, "count": 10}


@dataclass
class FakeController:
    """A loaded controller."""

    name: str
    type: str
    state: str = "initialized"
    gains: dict = field(default_factory=dict)

    def as_json(self):
        """Return it as the API does."""
        claims = {"hardware_interface": "hardware_interface::EffortJointInterface"}
        return {
            "name": self.name,
            "type": self.type,
            "state": self.state,
            "claimed_resources": [{**claims, "resources": JOINTS}],
            "fault": "",
            "traceback": "",
            "fallback": [],
            "time": NO_TIMES,
        }


def problem(status, code, detail, remedy=""):
    """Return a refusal as the API words it."""
    return JSONResponse(
        {
            "type": f"urn:control-station:problem:{code}",
            "title": code,
            "status": status,
            "detail": detail,
            "code": code,
            "remedy": remedy,
        },
        status,
        media_type="application/problem+json",
    )
