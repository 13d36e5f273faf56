"""Names of the protocol that every side must write alike: prefix and headers."""

from typing import Final

PREFIX: Final = "/api/v1"
"""Path below which the API answers."""
LEASE_HEADER: Final = "X-Control-Lease"
"""Header of a change: the lease of control that it is made under."""
KEY_HEADER: Final = "Idempotency-Key"
"""Header of a change: its name, with which it is carried out once."""
CLOCK_HEADER: Final = "X-Station-Clock"
"""Header of every answer: the station's wall time [s since 1970]."""
NOT_AFTER_HEADER: Final = "X-Not-After"
"""Header of a change: the latest time by that clock at which it may begin."""
REPLAYED_HEADER: Final = "Idempotent-Replayed"
"""Header of an answer: whether it is that of the first request with this key."""
MAX_BODY_BYTES: Final = 256 * 1024
"""Largest body of a request, which a dashboard may forward: parsing JSON holds the
interpreter, and with it the control loop."""
