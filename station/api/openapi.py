"""The OpenAPI document: what the framework writes, with our errors in it."""

from typing import Any

from fastapi import FastAPI
from typing_extensions import override

from station.wire import PROBLEM_MEDIA_TYPE, Problem

_REF = "#/components/schemas/"
_PROBLEM = {PROBLEM_MEDIA_TYPE: {"schema": {"$ref": f"{_REF}Problem"}}}
_OWN_ERRORS = ("HTTPValidationError", "ValidationError")


class StationApi(FastAPI):
    """A FastAPI whose document says that every error is a problem document."""

    @override
    def openapi(self) -> dict[str, Any]:
        """Return the document; made once."""
        if self.openapi_schema is None:
            document = super().openapi()
            schemas = document["components"]["schemas"]
            problem = Problem.model_json_schema(ref_template=_REF + "{model}")
            schemas.update(problem.pop("$defs"))
            schemas["Problem"] = problem
            for name in _OWN_ERRORS:
                schemas.pop(name, None)
            for methods in document["paths"].values():
                for operation in methods.values():
                    _complete(operation)
        return super().openapi()


def _complete(operation: dict[str, Any]) -> None:
    # "Raises" is for readers of the code; the responses say it to users.
    operation["description"] = operation["description"].partition("\n\nRaises:")[0]
    for status, response in operation["responses"].items():
        if status >= "4":
            response["content"] = _PROBLEM
