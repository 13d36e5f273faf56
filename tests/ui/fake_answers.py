"""Answers of the fake station."""

from dataclasses import dataclass, field

from starlette.responses import JSONResponse

JOINTS = [f"panda_joint{i}" for i in range(1, 8)]
NO_TIMES = {"p50": 0.0, "p99": 1.2e-4, "p999": 2e-4, "max": 1e-3, "count": 10}
LOOP = {
    "state": "running",
    "failure": "",
    "rate": 1000.0,
    "achieved_rate": 999.8,
    "period": 0.001,
    "cycles": 10,
    "skipped": 0,
    "real_time_factor": 1.0,
    "achieved_real_time_factor": 1.0,
    "scheduler": "fifo 80",
    **dict.fromkeys(("lateness", "read", "update", "write", "total"), NO_TIMES),
}
LIMITS = {
    "min_position": -2.5,
    "max_position": 2.5,
    "max_velocity": 2.0,
    "max_acceleration": None,
    "max_jerk": None,
    "max_effort": 87.0,
    "soft_limits": None,
    "sources": {},
}
HARDWARE = {
    "interfaces": [],
    "transmissions": [],
    "clamps": [],
    "repairs": [],
    "limits": [{"joint": name, **LIMITS} for name in JOINTS],
}
REFLEX = {
    "name": "cartesian_reflex",
    "where": "z",
    "value": -30.0,
    "limit": 20.0,
    "unit": "N",
    "cycle": 7,
    "description": "cartesian_reflex at z: -30 N, allowed is 20 N (cycle 7)",
}


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
            "fault": None,
            "traceback": None,
            "fallback": [],
            "time": NO_TIMES,
        }


def arm_report(arm_id, mode):
    """Return the state of an arm; an arm in reflex has an error."""
    return {
        "arm_id": arm_id,
        "robot_mode": mode,
        "connected": True,
        "errors": [REFLEX] if mode == "reflex" else [],
        "remedy": "" if mode == "idle" else "do something",
    }


def gain_schema(key):
    """Return unit and range of a gain, by the end of its name."""
    return {
        "type": "number",
        "unit": "Nm/rad" if key.endswith("p") else "Nm s/rad",
        "minimum": 0.0,
        "maximum": 1e4,
        "description": "Gain.",
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
