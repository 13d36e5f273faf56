"""The client for asyncio, and the source that `_sync` is generated from."""
