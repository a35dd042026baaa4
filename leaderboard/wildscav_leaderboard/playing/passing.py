"""Requests and WebSockets that the web server passes on to the process of a table."""

import asyncio
from collections.abc import Coroutine
from http import HTTPStatus
from typing import Any
from urllib.parse import quote

import httpx
from starlette.requests import Request
from starlette.responses import Response
from starlette.websockets import WebSocket, WebSocketDisconnect
from websockets.asyncio.client import ClientConnection, unix_connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from wildscav_leaderboard.playing.tables import OpenTable

ASKED = ("accept-encoding", "if-none-match")
KEPT = (
    "content-type",
    "location",
    "content-encoding",
    "vary",
    "etag",
    "content-security-policy",
    "cache-control",
    "referrer-policy",
    "x-content-type-options",
    "cross-origin-opener-policy",
    "cross-origin-resource-policy",
)
OVER = 4005  # close code of a page whose game is over
FINAL = 4000  # close codes from here on are the table's decisions about a page
BROKEN = 1012  # the code with which a page tries to connect again
PATIENCE = 10.0  # s for an answer
TOLD = 1.0  # s in which a table that ends says why
SPECIAL = (1005, 1006, 1015)  # codes that say that there was none


async def pass_request(table: OpenTable, path: str, request: Request) -> Response:
    """Return what a table answers to a request.

    Args:
        table: The table, which is ready.
    """
    url = httpx.URL(f"http://table/{quote(path)}", query=request.url.query.encode())
    asked = {name: request.headers.get(name, "") for name in ASKED}
    sent = await request.body() if request.method == "POST" else None
    transport = httpx.AsyncHTTPTransport(uds=str(table.socket), verify=False)
    try:
        async with (
            httpx.AsyncClient(transport=transport, timeout=PATIENCE, trust_env=False) as client,
            client.stream(request.method, url, headers=asked, content=sent) as answer,
        ):
            content = b"".join([part async for part in answer.aiter_raw()])  # as it was encoded
    except httpx.HTTPError:
        return Response("The game does not answer.", HTTPStatus.BAD_GATEWAY, media_type="text/plain")
    headers = {name: answer.headers[name] for name in KEPT if name in answer.headers}
    return Response(content, answer.status_code, headers)


async def pass_socket(table: OpenTable, path: str, page: WebSocket) -> None:
    """Pass messages on, both ways, until one of the two ends.

    Args:
        table: The table, which is ready.
        page: The page's connection, which is not accepted yet.
    """
    try:
        address = f"ws://table/{quote(path)}"
        async with unix_connect(
            str(table.socket), address, compression=None, open_timeout=PATIENCE
        ) as inside:
            await page.accept()
            await _first(_inwards(page, inside), _outwards(inside, page))
            code, reason = inside.close_code, inside.close_reason or ""
    except (OSError, InvalidHandshake, TimeoutError):
        return await refuse(page, OVER, table.why or "the link is not valid")
    if code is None or code < FINAL:
        code, reason = await _ending(table, code)
    return await _close(page, code, reason)


async def refuse(page: WebSocket, code: int, why: str) -> None:
    """Close a page's connection with a reason, which it can only see if it was accepted."""
    await page.accept()
    await page.close(code, why)


async def _ending(table: OpenTable, code: int | None) -> tuple[int, str]:
    """Return with which code and reason a page is closed whose table may be ending."""
    for _ in range(20):
        if not table.why:
            await asyncio.sleep(TOLD / 20)
    if table.why:
        return OVER, table.why
    return BROKEN if code is None or code in SPECIAL else code, ""


async def _close(page: WebSocket, code: int, reason: str) -> None:
    try:
        await page.close(code, reason.encode()[:120].decode(errors="ignore"))
    except (RuntimeError, WebSocketDisconnect):
        return  # the page has gone


async def _first(*works: Coroutine[Any, Any, None]) -> None:
    """Do several works until one of them ends."""
    tasks = [asyncio.create_task(work) for work in works]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _inwards(page: WebSocket, inside: ClientConnection) -> None:
    while (message := await page.receive())["type"] == "websocket.receive":
        await inside.send(message.get("text") or message.get("bytes") or "")


async def _outwards(inside: ClientConnection, page: WebSocket) -> None:
    try:
        while True:
            message = await inside.recv()
            if isinstance(message, str):
                await page.send_text(message)
            else:
                await page.send_bytes(message)
    except (ConnectionClosed, WebSocketDisconnect):
        return
