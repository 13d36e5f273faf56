"""What the user is told when a station runs."""

from dataclasses import dataclass
from urllib.parse import urlencode


@dataclass(frozen=True, slots=True)
class Announcement:
    """Where to find a station that has just started.

    Attributes:
        api_url: The API.
        ui_url: The dashboard; empty when there is none.
        token: The operator's token.
        runtime_file: Where the tokens are kept.
        scheduler: What the control thread was granted.
    """

    api_url: str
    ui_url: str
    token: str
    runtime_file: str
    scheduler: str

    @property
    def login_url(self) -> str:
        """Return the address that opens the dashboard and logs in."""
        return f"{self.ui_url}/login?{urlencode({'token': self.token})}"

    def lines(self) -> list[str]:
        """Return what to print, one line per address."""
        dashboard = [f"Dashboard  {self.login_url}"] if self.ui_url else []
        return [
            f"API        {self.api_url}/docs",
            *dashboard,
            f"Token      {self.token} (also in {self.runtime_file})",
            "Ctrl-C stops the station.",
        ]

    def as_json(self) -> dict[str, str]:
        """Return it as JSON-compatible data; the token is in the runtime file."""
        return {
            "api_url": self.api_url,
            "ui_url": self.ui_url,
            "runtime_file": self.runtime_file,
            "scheduler": self.scheduler,
        }
