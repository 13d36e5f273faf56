"""The lines that a starting station prints for its user."""

from dataclasses import dataclass
from urllib.parse import urlencode


@dataclass(frozen=True, slots=True)
class Announcement:
    """The addresses of a station that has just started.

    Attributes:
        api_url: The API.
        ui_url: The dashboard; empty when there is none.
        token: The operator's token.
        runtime_file: Store of the tokens.
        scheduler: Scheduling that the control thread was granted.
        robot: SIMULATION or REAL ARM, as in the dashboard's strip.
        kernel: Whether the cycle's arithmetic runs interpreted or compiled, and why.
    """

    api_url: str
    ui_url: str
    token: str
    runtime_file: str
    scheduler: str
    robot: str
    kernel: str

    def lines(self) -> list[str]:
        """Return the lines to print at once."""
        return [
            f"API        {self.api_url}/docs",
            f"Token      {self.token} (also in {self.runtime_file})",
            f"Robot      {self.robot}",
            f"Cycle      {self.kernel}",
        ]

    def dashboard_line(self) -> str:
        """Return the line for a dashboard that answers: an address that logs in."""
        return f"Dashboard  {self.ui_url}/login?{urlencode({'token': self.token})}"

    def as_json(self) -> dict[str, str]:
        """Return it as JSON-compatible data; the token is in the runtime file."""
        return {
            "api_url": self.api_url,
            "ui_url": self.ui_url,
            "runtime_file": self.runtime_file,
            "scheduler": self.scheduler,
            "robot": self.robot,
            "kernel": self.kernel,
        }
