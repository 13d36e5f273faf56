"""Make tools for agents from the OpenAPI document of the station.

The document says of each operation whether agents may call it (`x-agent`), so a new
operation becomes a tool without a change here.
"""

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import mcp_types as types

from station.client.connection import segment

_REF = "#/components/schemas/"
_REFERENCE = re.compile(f'"{_REF}([^"]+)"')
_BODY = "body"
_ROUTE = re.compile(r"\b([A-Z]+) (/api/v1/[^\s'`,;.]+)")


@dataclass(frozen=True, slots=True)
class StationTool:
    """An operation of the API that an agent may call.

    Attributes:
        offer: Name, effect and JSON schema of the arguments, for the agent; those of
            the body are under `body`.
        seat: Agents' right to the operation: `read`; `free` (without asking); or
            `asked` (once a person has allowed the call).
        method: HTTP method.
        path: Path with `{names}` of parameters.
        places: `path` or `query` of each parameter.
    """

    offer: types.Tool
    seat: str
    method: str
    path: str
    places: Mapping[str, str]

    def request(self, arguments: Mapping[str, Any]) -> tuple[str, dict[str, Any], Any]:
        """Return path, query and body of a call.

        Args:
            arguments: Arguments by name.

        Raises:
            ValueError: An argument is unknown, an argument of the path is missing, or
                the body is not an object.
        """
        name, known = self.offer.name, self.offer.input_schema["properties"].keys()
        unknown = arguments.keys() - known
        needed = {name for name, place in self.places.items() if place == "path"}
        if unknown or needed - arguments.keys():
            raise ValueError(
                f"{name} takes {_listed(known)}; it needs {_listed(needed)}; "
                f"given is {_listed(arguments)}."
            )
        path, query = self.path, {}
        for key, place in self.places.items():
            if place == "path":
                path = path.replace(f"{{{key}}}", segment(str(arguments[key])))
            elif key in arguments:
                query[key] = arguments[key]
        body = arguments.get(_BODY)
        if body is not None and not isinstance(body, dict):
            raise ValueError(f"The body of {name} is an object, not {body!r:.80}.")
        return path, query, body


def in_terms_of_tools(text: str, tools: Iterable[StationTool]) -> str:
    """Return a text of the API that names tools in place of their routes.

    Args:
        text: What the station says, e.g. `GET /api/v1/control says who holds control.`
        tools: The tools.
    """

    def named(route: re.Match[str]) -> str:
        method, path = route.groups()
        for tool in tools:
            form = re.sub(r"\\{\w+\\}", "[^/]+", re.escape(tool.path))
            if tool.method == method and re.fullmatch(form, path):
                return f"`{tool.offer.name}`"
        return route[0]

    return _ROUTE.sub(named, text)


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"'{name:.80}'" for name in sorted(names)) or "nothing"


def tools_of(document: Mapping[str, Any]) -> dict[str, StationTool]:
    """Return the tools by name.

    Args:
        document: OpenAPI document of a station.
    """
    found = {}
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            if "x-agent" in operation:
                tool = _tool(path, method, operation, document)
                found[tool.offer.name] = tool
    return found


def _tool(
    path: str,
    method: str,
    operation: Mapping[str, Any],
    document: Mapping[str, Any],
) -> StationTool:
    parameters = [p for p in operation.get("parameters", ()) if p["in"] != "header"]
    properties = {
        p["name"]: {**p["schema"], "description": p.get("description", "")}
        for p in parameters
    }
    required = [p["name"] for p in parameters if p.get("required")]
    body = operation.get("requestBody")
    if body is not None:
        properties[_BODY] = body["content"]["application/json"]["schema"]
        if body.get("required"):
            required.append(_BODY)
    schema = {"type": "object", "properties": properties, "required": required}
    seat = operation["x-agent"]
    offer = types.Tool(
        name=operation["operationId"],
        description=operation["description"],
        input_schema=_localised(schema, document["components"]["schemas"]),
        annotations=types.ToolAnnotations(
            read_only_hint=seat == "read", destructive_hint=seat == "asked"
        ),
    )
    places = {p["name"]: p["in"] for p in parameters}
    return StationTool(offer, seat, method.upper(), path, places)


def _localised(schema: dict[str, Any], schemas: Mapping[str, Any]) -> dict[str, Any]:
    """Return a schema that contains all schemas to which it refers."""
    definitions: dict[str, Any] = {}
    pending = [schema]
    for one in pending:
        for name in _REFERENCE.findall(json.dumps(one)):
            if name not in definitions:
                definitions[name] = schemas[name]
                pending.append(schemas[name])
    whole = {**schema, "$defs": definitions} if definitions else schema
    found: dict[str, Any] = json.loads(json.dumps(whole).replace(_REF, "#/$defs/"))
    return found
