"""What of a table's answers reaches a browser."""

import asyncio
import gzip
import socket
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from wildscav_leaderboard.playing.passing import pass_request


def answer(request: Request) -> Response:
    if request.headers.get("if-none-match") == '"7"':
        return Response(status_code=304, headers={"ETag": '"7"'})
    assert request.headers["accept-encoding"] == "gzip"
    told = {"ETag": '"7"', "Content-Encoding": "gzip", "Vary": "Accept-Encoding", "Server-Timing": "no"}
    return Response(gzip.compress(request.url.query.encode()), headers=told)


def asked(query: str, **headers: str) -> Request:
    told = [(name.replace("_", "-").encode(), value.encode()) for name, value in headers.items()]
    what = {"type": "http", "method": "GET", "path": "/", "query_string": query.encode()}
    return Request({**what, "headers": told})


def test_compression_versions_and_keys_are_passed_on(tmp_path: Path) -> None:
    async def ask() -> list[Response]:
        table: Any = SimpleNamespace(socket=tmp_path / "table")
        site = Starlette(routes=[Route("/static/play.js", answer)])
        listening = socket.socket(socket.AF_UNIX)
        listening.bind(str(table.socket))
        listening.listen()
        web = uvicorn.Server(uvicorn.Config(site, log_level="error", lifespan="off"))
        serving = asyncio.create_task(web.serve(sockets=[listening]))
        requests = (asked("v=1", accept_encoding="gzip"), asked("v=1", if_none_match='"7"'))
        answers = [await pass_request(table, "static/play.js", request) for request in requests]
        web.should_exit = True
        await serving
        return answers

    whole, kept = asyncio.run(ask())
    assert gzip.decompress(cast("bytes", whole.body)) == b"v=1"
    assert (whole.headers["content-encoding"], whole.headers["vary"]) == ("gzip", "Accept-Encoding")
    assert "server-timing" not in whole.headers
    assert (kept.status_code, kept.body, kept.headers["etag"]) == (304, b"", '"7"')
