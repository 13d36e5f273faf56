"""The REST and WebSocket interface of a station."""
