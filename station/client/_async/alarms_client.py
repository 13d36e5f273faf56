"""The client of a station's alarms."""

from station import wire
from station.client._async.connection import AsyncConnection


class AsyncAlarmsClient:
    """What asks for a person: `client.alarms`.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def list(self) -> list[wire.Alarm]:
        """Return the alarms whose cause is there or that nobody has acknowledged."""
        return (await self._connection.get("/alarms", wire.Alarms)).alarms

    async def acknowledge(self, number: int) -> wire.Alarm:
        """Say that an alarm was seen; its cause stays.

        Args:
            number: The `id` of the alarm.
        """
        path = f"/alarms/{number:d}/acknowledge"
        return await self._connection.send("POST", path, wire.Alarm)
