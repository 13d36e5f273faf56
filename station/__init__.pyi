from station.app.in_process import open_station as open  # noqa: A004 - as gzip.open
from station.app.rerun import rerun as rerun

__version__: str
__all__ = ["__version__", "open"]
