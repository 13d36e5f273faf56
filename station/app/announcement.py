"""The lines that a starting station prints for its user."""

from dataclasses import dataclass
from urllib.parse import urlencode


@dataclass(frozen=True, slots=True)
class Announcement:
    """The addresses of a station that has just started.

    Attributes:
        api_url: URL of the API.
        ui_url: URL of the dashboard; empty without a dashboard.
        token: The operator's token.
        runtime_file: File with the tokens.
        scheduler: Scheduling class that the control thread was granted.
        robot: `SIMULATION` or `REAL ARM`, as at the top of the dashboard.
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
        """Return the lines to print when the API answers."""
        return [
            f"API        {self.api_url}/docs",
            f"Token      {self.token} (also in {self.runtime_file})",
            f"Robot      {self.robot}",
            f"Cycle      {self.kernel}",
        ]

    def dashboard_line(self) -> str:
        """Return the line for an answering dashboard, with an address that logs in."""
        return f"Dashboard  {self.ui_url}/login?{urlencode({'token': self.token})}"

    def as_json(self) -> dict[str, str]:
        """Return JSON-compatible data; the token is only in the runtime file."""
        return {
            "api_url": self.api_url,
            "ui_url": self.ui_url,
            "runtime_file": self.runtime_file,
            "scheduler": self.scheduler,
            "robot": self.robot,
            "kernel": self.kernel,
        }
