"""The server of the Model Context Protocol: a client of one station, for one agent.

Its tools are made from the OpenAPI document of the station, which says of each
operation whether agents may call it (`x-agent`), so a new operation becomes a tool
without a change here.
"""

import contextlib
import json
import re
from collections.abc import AsyncIterator, Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path
from typing import Any

import mcp_types as types
from mcp import MCPError
from mcp.server.lowlevel import Server
from mcp.server.stdio import stdio_server

from station.client import ApiError
from station.client.connection import AsyncConnection, segment
from station.local.tls import trust
from station.wire.protocol import PREFIX

_REF = "#/components/schemas/"
_REFERENCE = re.compile(f'"{_REF}([^"]+)"')
_BODY = "body"
_ROUTE = re.compile(r"\b([A-Z]+) (/api/v1/[^\s'`,;.]+)")
_JSON: type[Any] = object
_WITHOUT_CONTROL = ("stop", "take_control", "renew_control", "release_control")
_PAGES = Path(__file__).parents[2] / "docs"
"""Folder of the docs in a clone; an installed package has none."""
TIMEOUT = 10.0
"""Longest wait for an answer that needs no person [s]."""
LEASE = 30.0
"""Time after the last call for which the agent keeps control [s]."""
PATIENCE = 120.0
"""Extra time to wait for an answer [s], because a person may have to decide."""


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


def _text(name: str) -> str:
    return files(__package__).joinpath(f"{name}.md").read_text(encoding="utf-8")


_PROMPTS = {name: _text(name).split("\n", 1) for name in ("tune", "diagnose")}
"""Title and text of each prompt; the text has a place for the subject."""
_EXPLAIN = types.Tool(
    name="explain_last_refusal",
    description="Say why the last call was refused, and what the station suggests, "
    "with the latest incidents.",
    input_schema={"type": "object", "properties": {}},
)
_RESOURCES = {
    "station://robot": ("/hardware", "The robots, with joints and limits"),
    "station://events": ("/events", "The latest events, newest last"),
}
"""Path in the API and description of each resource that is no page of the docs."""


class AgentServer:
    """Tools, resources and prompts of one station. For one event loop.

    Args:
        connection: The station, with the token of an agent.
        document: OpenAPI document of the station.
        pages: Folder of the docs; none are offered when None.
        journal: File that takes every call as a line of JSON; None for none.
    """

    def __init__(
        self,
        connection: AsyncConnection,
        document: dict[str, Any],
        pages: Path | None = None,
        journal: Path | None = None,
    ) -> None:
        self._connection = connection
        self._tools = tools_of(document)
        found = [] if pages is None else sorted(pages.glob("*.md"))
        self._pages = {f"station://docs/{page.name}": page for page in found}
        self._journal = journal
        self._refusal: str | None = None
        self.server: Server[Any] = Server(
            "control-station",
            instructions=_text("instructions"),
            on_list_tools=self._list_tools,
            on_call_tool=self._call_tool,
            on_list_resources=self._list_resources,
            on_read_resource=self._read_resource,
            on_list_prompts=self._list_prompts,
            on_get_prompt=self._get_prompt,
        )

    async def call(self, name: str, arguments: dict[str, Any]) -> tuple[str, bool]:
        """Call a tool; return the answer, and whether it is a refusal.

        Args:
            name: The tool.
            arguments: Its arguments.
        """
        if name == _EXPLAIN.name:
            return await self._explain(), False
        tool = self._tools.get(name)
        if tool is None:
            near = get_close_matches(name, self._tools, 1)
            meant = f" Did you mean '{near[0]}'?" if near else ""
            return self._refused(f"There is no tool '{name:.80}'.{meant}")
        try:
            async with self._control(tool):
                return json.dumps(await self._send(tool, arguments)), False
        except ApiError as refused:
            why = in_terms_of_tools(str(refused), self._tools.values())
            return self._refused(f"Refused ({refused.code}): {why}")
        except ValueError as error:
            return self._refused(str(error))
        finally:
            self._note(name, arguments)

    def _refused(self, why: str) -> tuple[str, bool]:
        self._refusal = why
        return why, True

    async def _send(self, tool: StationTool, arguments: dict[str, Any]) -> Any:  # noqa: ANN401 - any JSON
        path, query, body = tool.request(arguments)
        return await self._connection.send(
            tool.method,
            path.removeprefix(PREFIX),
            _JSON,
            body,
            query=query,
            patience=0.0 if tool.seat == "read" else PATIENCE,
        )

    @contextlib.asynccontextmanager
    async def _control(self, tool: StationTool) -> AsyncIterator[None]:
        """Hold control during a call that asks for a change, and for a while after it.

        Heartbeats keep control while a person decides. Between calls the agent sends
        none, so that an agent that falls silent loses control.
        """
        if tool.seat == "read" or tool.offer.name in _WITHOUT_CONTROL:
            yield
            return
        lease = {"ttl": LEASE}
        await self._connection.send("POST", "/control", _JSON, lease)
        stop_beating = self._connection.repeat(self._beat, LEASE / 3.0)
        try:
            yield
        finally:
            await stop_beating()

    async def _beat(self) -> bool:
        # If control was lost, the answer to the call says so.
        with contextlib.suppress(ApiError):
            await self._connection.send("PATCH", "/control", _JSON, {"ttl": LEASE})
        return True

    def _note(self, name: str, arguments: dict[str, Any]) -> None:
        if self._journal is not None:
            with self._journal.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"tool": name, "arguments": arguments}) + "\n")

    async def _explain(self) -> str:
        why = self._refusal or "No call was refused."
        try:
            found = await self._connection.get("/incidents", _JSON)
        except ApiError as refused:
            return f"{why} Of incidents nothing is known: {refused}"
        return f"{why} Latest incidents: {json.dumps(found['recordings'][-3:])}"

    async def _list_tools(self, *_: object) -> types.ListToolsResult:
        tools = [tool.offer for tool in self._tools.values()]
        return types.ListToolsResult(tools=[*tools, _EXPLAIN])

    async def _call_tool(
        self, _: object, asked: types.CallToolRequestParams
    ) -> types.CallToolResult:
        text, is_refusal = await self.call(asked.name, asked.arguments or {})
        content = types.TextContent(text=text)
        return types.CallToolResult(content=[content], is_error=is_refusal)

    async def _list_resources(self, *_: object) -> types.ListResourcesResult:
        found = [
            types.Resource(uri=uri, name=name) for uri, (_, name) in _RESOURCES.items()
        ]
        found += [
            types.Resource(uri=uri, name=page.stem, mime_type="text/markdown")
            for uri, page in self._pages.items()
        ]
        return types.ListResourcesResult(resources=found)

    async def _read_resource(
        self, _: object, asked: types.ReadResourceRequestParams
    ) -> types.ReadResourceResult:
        if asked.uri in self._pages:
            text = self._pages[asked.uri].read_text(encoding="utf-8")
        elif asked.uri in _RESOURCES:
            try:
                found = await self._connection.get(_RESOURCES[asked.uri][0], _JSON)
            except ApiError as refused:
                raise MCPError(types.INTERNAL_ERROR, str(refused)) from refused
            text = json.dumps(found)
        else:
            raise _no_such("resource", asked.uri)
        content = types.TextResourceContents(uri=asked.uri, text=text)
        return types.ReadResourceResult(contents=[content])

    async def _list_prompts(self, *_: object) -> types.ListPromptsResult:
        subject = types.PromptArgument(
            name="subject", description="A controller, or a robot.", required=True
        )
        return types.ListPromptsResult(
            prompts=[
                types.Prompt(name=name, description=title, arguments=[subject])
                for name, (title, _) in _PROMPTS.items()
            ]
        )

    async def _get_prompt(
        self, _: object, asked: types.GetPromptRequestParams
    ) -> types.GetPromptResult:
        if asked.name not in _PROMPTS:
            raise _no_such("prompt", asked.name)
        subject = (asked.arguments or {}).get("subject")
        if not subject:
            raise MCPError(
                types.INVALID_PARAMS,
                f"The prompt '{asked.name}' needs a 'subject': a controller, or a "
                "robot.",
            )
        text = _PROMPTS[asked.name][1].format(subject=subject)
        message = types.PromptMessage(role="user", content=types.TextContent(text=text))
        return types.GetPromptResult(messages=[message])


@contextlib.asynccontextmanager
async def connect(
    url: str, token: str, ca: str | None = None, journal: Path | None = None
) -> AsyncIterator[AgentServer]:
    """Connect to a station for the duration of a `with` block.

    Args:
        url: The station.
        token: The token of an agent.
        ca: PEM file with the certificates to trust with an https `url`.
        journal: File that takes every call as a line of JSON; None for none.

    Raises:
        ApiError: The station does not know the token.
        StationUnreachableError: The station does not answer.
    """
    tls = trust(url, ca)
    connection = AsyncConnection(url.rstrip("/"), token, TIMEOUT, tls=tls)
    try:
        document = await connection.get("/openapi.json", _JSON)
        yield AgentServer(connection, document, _PAGES, journal)
    finally:
        await connection.close()


async def serve(url: str, token: str, ca: str | None, journal: Path | None) -> None:
    """Serve the program that has started this process, until it closes the pipe."""
    async with (
        connect(url, token, ca, journal) as seat,
        stdio_server() as (incoming, outgoing),
    ):
        options = seat.server.create_initialization_options()
        await seat.server.run(incoming, outgoing, options)


async def replay(
    url: str, token: str, ca: str | None, journal: Path
) -> AsyncIterator[tuple[str, bool, str]]:
    """Make the calls of a journal again; yield tool, whether it failed, and answer.

    Args:
        url: The station.
        token: The token of an agent.
        ca: PEM file with the certificates to trust with an https `url`.
        journal: A file that a server has written.
    """
    async with connect(url, token, ca) as seat:
        for line in journal.read_text(encoding="utf-8").splitlines():
            call = json.loads(line)
            text, is_refusal = await seat.call(call["tool"], call["arguments"])
            yield call["tool"], is_refusal, text


def _no_such(kind: str, name: str) -> MCPError:
    return MCPError(types.INVALID_PARAMS, f"There is no {kind} {name!r:.200}.")
