"""Make tools for agents from the OpenAPI document of the station.

The document says of each operation whether agents may call it (`x-agent`), so a new
operation becomes a tool without a change here.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from station.client.connection import segment

_REF = "#/components/schemas/"
_BODY = "body"
_ROUTE = re.compile(r"\b([A-Z]+) (/api/v1/[^\s'`,;.]+)")


@dataclass(frozen=True, slots=True)
class StationTool:
    """An operation of the API that an agent may call.

    Attributes:
        name: Name of the operation.
        description: Effect, for the agent.
        seat: Agents' right to the operation: `read`; `free` (without asking); or
            `asked` (once a person has allowed the call).
        method: HTTP method.
        path: Path with `{names}` of parameters.
        places: `path` or `query` of each parameter.
        schema: JSON schema of the arguments; those of the body are under `body`.
    """

    name: str
    description: str
    seat: str
    method: str
    path: str
    places: Mapping[str, str]
    schema: dict[str, Any]

    def request(self, arguments: Mapping[str, Any]) -> tuple[str, dict[str, Any], Any]:
        """Return path, query and body of a call.

        Args:
            arguments: Arguments by name.

        Raises:
            ValueError: An argument is unknown, an argument of the path is missing, or
                the body is not an object.
        """
        known = self.schema["properties"].keys()
        unknown = arguments.keys() - known
        needed = {name for name, place in self.places.items() if place == "path"}
        if unknown or needed - arguments.keys():
            raise ValueError(
                f"{self.name} takes {_listed(known)}; it needs {_listed(needed)}; "
                f"given is {_listed(arguments)}."
            )
        path, query = self.path, {}
        for name, place in self.places.items():
            if place == "path":
                path = path.replace(f"{{{name}}}", segment(str(arguments[name])))
            elif name in arguments:
                query[name] = arguments[name]
        body = arguments.get(_BODY)
        if body is not None and not isinstance(body, dict):
            raise ValueError(f"The body of {self.name} is an object, not {body!r:.80}.")
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
                return f"`{tool.name}`"
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
                found[tool.name] = tool
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
    definitions: dict[str, Any] = {}
    schema = _localised(schema, document["components"]["schemas"], definitions)
    if definitions:
        schema["$defs"] = definitions
    return StationTool(
        operation["operationId"],
        operation["description"],
        operation["x-agent"],
        method.upper(),
        path,
        {p["name"]: p["in"] for p in parameters},
        schema,
    )


def _localised(
    part: Any,  # noqa: ANN401 - any part of a JSON schema
    schemas: Mapping[str, Any],
    definitions: dict[str, Any],
) -> Any:  # noqa: ANN401 - the same kind of part
    """Return a schema that contains all schemas to which it refers."""
    if isinstance(part, list):
        return [_localised(each, schemas, definitions) for each in part]
    if not isinstance(part, dict):
        return part
    reference = part.get("$ref", "")
    if isinstance(reference, str) and reference.startswith(_REF):
        name = reference.removeprefix(_REF)
        if name not in definitions:
            definitions[name] = {}  # a schema may refer to itself
            definitions[name] = _localised(schemas[name], schemas, definitions)
        return {"$ref": f"#/$defs/{name}"}
    return {
        key: _localised(value, schemas, definitions)
        for key, value in part.items()
        # The mapping of a union refers to the document, which the tool does not have.
        if key != "discriminator"
    }
