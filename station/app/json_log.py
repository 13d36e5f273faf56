"""Write the log as JSON, one object per line, for programs that collect logs."""

import json
import logging
from datetime import UTC, datetime

from typing_extensions import override

from station.web.request_id import RequestIdFilter

TEXT, JSON = "text", "json"


class JsonFormatter(logging.Formatter):
    """Writes a record with `time`, `level`, `logger`, `message`.

    A record may also have `request_id` and `exception` (the traceback).
    """

    @override
    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, object] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        request_id = getattr(record, "request_id", None)
        if request_id is not None:
            line["request_id"] = request_id
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line, default=str)


def set_up_log(form: str) -> None:
    """Make the process log to stderr.

    Args:
        form: `text` is for people and has warnings only; `json` is for programs and
            also has the requests that changed something or were refused.
    """
    handler = logging.StreamHandler()
    if form == JSON:
        handler.setFormatter(JsonFormatter())
        handler.addFilter(RequestIdFilter())
        logging.getLogger("station").setLevel(logging.INFO)
    else:
        handler.setFormatter(logging.Formatter("%(levelname)s: %(message)s"))
    logging.getLogger().addHandler(handler)
