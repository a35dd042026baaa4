"""The protocol: the desk's answers as MCP has them, over standard input and output, or over HTTP."""

import asyncio
import base64
import secrets
import socket
from collections.abc import Mapping, Sequence
from types import FrameType
from typing import Any

import mcp_types as types
import uvicorn
from mcp.server.lowlevel.server import Server
from mcp.server.stdio import stdio_server
from mcp.server.transport_security import TransportSecuritySettings
from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Route
from starlette.types import ASGIApp, Receive, Scope, Send

from wildscav.errors import UserError
from wildscav.version import __version__
from wildscav_language.calls import Tool
from wildscav_language.mcp_server.desk import ACTS, RECORD_ADDRESS, REPLAY, Answer, Desk
from wildscav_language.mcp_server.matches import Matches
from wildscav_language.tools import TOOLS

PATH = "/mcp"
REPLAYS = "/replays/{key}"
CLOSING_TIME = 2  # s that open calls have to be answered when the matches have been ended
LONGEST_ANSWER = 64_000  # bytes of text
LARGEST_PICTURE = 1 << 20  # bytes
LARGEST_RECORD = 1 << 20  # bytes that a resource may have
LARGEST_REQUEST = 64 << 10  # bytes
BINARY = "application/octet-stream"
INSTRUCTIONS = (
    "Wildscav is a 3D arena for agents. Start a match with start_match or join one with join_match, and keep "
    "the handle of your seat: every call needs it. Read the rules, observe, then act with tools such as "
    "look_around, go, explore or attack. Each plays game time until it ends, and tells why it did. Between "
    "your calls, the match waits for you."
)
Content = types.TextContent | types.ImageContent


def make_server(desk: Desk) -> "Server[Any]":
    """Return a server of MCP, whose calls the desk answers."""

    async def list_tools(_context: Any, _params: Any) -> types.ListToolsResult:
        return types.ListToolsResult(tools=all_tools())

    async def call_tool(_context: Any, params: types.CallToolRequestParams) -> types.CallToolResult:
        try:
            answer = await desk.answer(params.name, params.arguments or {})
        except UserError as error:
            answer = Answer(str(error), is_refusal=True)
        return types.CallToolResult(content=[*_content(answer)], is_error=answer.is_refusal)

    async def list_templates(_context: Any, _params: Any) -> types.ListResourceTemplatesResult:
        record = types.ResourceTemplate(
            name="record",
            uri_template=RECORD_ADDRESS,
            description="The record of a match that is over: its spec and all actions.",
            mime_type=BINARY,
        )
        return types.ListResourceTemplatesResult(resource_templates=[record])

    async def list_resources(_context: Any, _params: Any) -> types.ListResourcesResult:
        # Whoever knows an address may read the record, so they are not listed where several clients ask.
        over = [match for match in desk.matches if desk.is_local and match.result is not None]
        addresses = {match.id: RECORD_ADDRESS.format(key=match.key) for match in over}
        resources = [types.Resource(name=name, uri=uri, mime_type=BINARY) for name, uri in addresses.items()]
        return types.ListResourcesResult(resources=resources)

    async def read_resource(
        _context: Any, params: types.ReadResourceRequestParams
    ) -> types.ReadResourceResult:
        data = await asyncio.to_thread(_record_at, desk, str(params.uri))
        blob = base64.b64encode(data).decode()
        contents = types.BlobResourceContents(uri=params.uri, blob=blob, mime_type=BINARY)
        return types.ReadResourceResult(contents=[contents])

    return Server(
        "wildscav",
        version=__version__,
        instructions=INSTRUCTIONS,
        on_list_tools=list_tools,
        on_call_tool=call_tool,
        on_list_resources=list_resources,
        on_list_resource_templates=list_templates,
        on_read_resource=read_resource,
    )


THOUGHT = {
    "type": "string",
    "description": "why you do it, in a sentence: replays show it, and nobody in the match hears it",
}


def all_tools() -> list[types.Tool]:
    """Return all tools: the requests, and the tools of seats of all tracks."""
    requests = [
        types.Tool(name=name, description=kind.__doc__, input_schema=_without_title(kind.model_json_schema()))
        for name, (kind, _) in ACTS.items()
    ]
    return [*requests, *(_of_seat(tool) for tool in TOOLS)]


def _of_seat(tool: Tool) -> types.Tool:
    """Return a tool of a seat, whose calls have the seat's handle besides."""
    schema = _without_title(tool.schema)
    handle = ACTS["observe"][0].model_json_schema()["properties"]["seat"]
    schema["properties"] = {"seat": handle, **schema.get("properties", {}), "thought": THOUGHT}
    schema["required"] = ["seat", *schema.get("required", ())]
    return types.Tool(name=tool.name, description=tool.description, input_schema=schema)


def _without_title(schema: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in schema.items() if name not in {"title", "description"}}


def _content(answer: Answer) -> list[Content]:
    text = answer.text.encode()[:LONGEST_ANSWER].decode(errors="ignore")
    content: list[Content] = [types.TextContent(type="text", text=text)]
    if answer.picture is not None and len(answer.picture) <= LARGEST_PICTURE:
        data = base64.b64encode(answer.picture).decode()
        content.append(types.ImageContent(type="image", data=data, mime_type="image/png"))
    return content


def _record_at(desk: Desk, address: str) -> bytes:
    """Return the record at the address of a resource.

    Raises:
        ValueError: There is none, or it is too large.
    """
    for match in desk.matches:
        if match.result is not None and address == RECORD_ADDRESS.format(key=match.key):
            if match.record.stat().st_size > LARGEST_RECORD:
                raise ValueError(f"the record is larger than {LARGEST_RECORD:,} bytes")
            return match.record.read_bytes()
    raise ValueError(f"there is no {address[:100]}")


async def serve_stdio(desk: Desk) -> None:
    """Serve the client at the other end of standard input and output until it leaves."""
    server = make_server(desk)
    async with stdio_server() as (reading, writing):
        await server.run(reading, writing, server.create_initialization_options())


async def serve_http(
    desk: Desk, sockets: list[socket.socket], token: str | None, hosts: Sequence[str] | None
) -> None:
    """Serve any number of clients over HTTP until the server is interrupted; then end all matches first.

    With a token, each request must carry it. With ``hosts``, clients reach the server by these names alone.
    """
    names = [name for host in hosts or () for name in (host, f"{host}:*")]
    app = make_server(desk).streamable_http_app(
        streamable_http_path=PATH,
        json_response=True,
        stateless_http=True,
        max_request_body_size=LARGEST_REQUEST,
        transport_security=TransportSecuritySettings(
            enable_dns_rebinding_protection=hosts is not None,
            allowed_hosts=names,
            allowed_origins=[f"{scheme}://{name}" for scheme in ("http", "https") for name in names],
        ),
        custom_starlette_routes=[Route(REPLAYS, _replays(desk))],
    )
    config = uvicorn.Config(
        app if token is None else _WithToken(app, token),
        log_level="warning",
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=CLOSING_TIME,
    )
    await _Server(config, desk.matches).serve(sockets=sockets)


class _Server(uvicorn.Server):
    """Ends the matches when it is interrupted, so that open calls are answered, and then itself."""

    def __init__(self, config: uvicorn.Config, matches: Matches) -> None:
        super().__init__(config)
        self._matches, self._loop = matches, asyncio.get_running_loop()
        self._ending: asyncio.Task[None] | None = None

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Take a signal; a second one ends the server at once."""
        if self._ending is not None:
            super().handle_exit(sig, frame)
        self._loop.call_soon_threadsafe(self._end)

    def _end(self) -> None:
        self._ending = self._ending or asyncio.create_task(self._close())

    async def _close(self) -> None:
        await self._matches.close()
        self.should_exit = True


def _replays(desk: Desk) -> Any:
    async def replay(request: Request) -> Response:
        for match in desk.matches:
            is_asked = secrets.compare_digest(match.key.encode(), request.path_params["key"].encode())
            if is_asked and (match.folder / REPLAY).exists():
                return FileResponse(match.folder / REPLAY, media_type="text/html")
        raise HTTPException(404)

    return replay


class _WithToken:
    """Refuses requests that do not carry a token; browsers carry none, and links of replays have a secret."""

    def __init__(self, app: Starlette, token: str) -> None:
        self._app: ASGIApp = app
        self._wanted = f"Bearer {token}".encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http" and not scope["path"].startswith(REPLAYS.format(key="")):
            given = dict(scope["headers"]).get(b"authorization", b"")
            if not secrets.compare_digest(given, self._wanted):
                answer = PlainTextResponse("a token is needed: Authorization: Bearer TOKEN\n", 401)
                return await answer(scope, receive, send)
        return await self._app(scope, receive, send)
