# Generated from _async/alarms_client.py by tools/generate_client.py.
"""The client of a station's alarms."""

from station import wire
from station.client._sync.connection import Connection


class AlarmsClient:
    """What asks for a person: `client.alarms`.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def list(self) -> list[wire.Alarm]:
        """Return the alarms whose cause is there or that nobody has acknowledged."""
        return (self._connection.get("/alarms", wire.Alarms)).alarms

    def acknowledge(self, number: int) -> wire.Alarm:
        """Say that an alarm was seen; its cause stays.

        Args:
            number: The `id` of the alarm.
        """
        path = f"/alarms/{number:d}/acknowledge"
        return self._connection.send("POST", path, wire.Alarm)
