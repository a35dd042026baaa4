"""A replay in a browser: a server for Rerun's web viewer and one recording.

The viewer comes from the installed Rerun package. The content security policy of the pages forbids requests
to any other host.
"""

import os
import socket
import subprocess
import time
from collections.abc import Mapping
from http.client import HTTPException
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from ipaddress import ip_address
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, ClassVar, Final, NamedTuple
from urllib.error import URLError
from urllib.parse import urlencode, urlsplit
from urllib.request import ProxyHandler, build_opener

from wildscav_engine.view.replay import ViewError

LOOPBACK = "127.0.0.1"
PATIENCE = 60.0  # s for Rerun to deliver its viewer
TYPES = {
    "/index.html": "text/html; charset=utf-8",
    "/re_viewer.js": "text/javascript",
    "/re_viewer_bg.wasm": "application/wasm",
    "/favicon.ico": "image/x-icon",
}
RECORDING = "/replay.rrd"
PLAIN = "text/plain; charset=utf-8"
VIEWER_OPTIONS = {"hide_welcome_screen": "", "persist": "0", "renderer": "webgl"}
POLICY = (
    "default-src 'none'; connect-src 'self'; img-src 'self' data: blob:; style-src 'unsafe-inline'; "
    "script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; worker-src 'self' blob:"
)


class Content(NamedTuple):
    """The response body of one path."""

    media_type: str
    body: bytes


class ReplayServer(ThreadingHTTPServer):
    """An HTTP server for one replay and the web viewer."""

    daemon_threads = True

    def __init__(self, replay: bytes, host: str = LOOPBACK, port: int = 0) -> None:
        """Start to listen; ``serve_forever`` answers requests.

        Args:
            replay: The content of an ``.rrd`` file.
            host: The address to listen on.
            port: The port; 0 for any free one.

        Raises:
            ViewError: Rerun or its web viewer is missing, or the server cannot listen on the address.
        """
        self.content: Final[Mapping[str, Content]] = {
            **{path: Content(TYPES[path], body) for path, body in viewer_files().items()},
            RECORDING: Content("application/octet-stream", replay),
        }
        self.host: Final = host
        self.address_family = socket.AF_INET6 if ":" in host else socket.AF_INET
        try:
            super().__init__((host, port), _Handler)
        except (OSError, OverflowError) as error:
            raise ViewError(f"cannot listen on {host}, port {port}: {error}") from None

    @property
    def link(self) -> str:
        """The URL to open in a browser; for a wildcard address, the one on this machine."""
        return link_to(str(self.server_address[0]), self.server_address[1])


def link_to(host: str, port: int) -> str:
    """Return the URL of the root of a web server; for a wildcard address, the one on this machine."""
    host = {"0.0.0.0": LOOPBACK, "::": "::1"}.get(host, host)  # noqa: S104 - only compared
    return f"http://{f'[{host}]' if ':' in host else host}:{port}/"


def is_own_name(header: str, host: str) -> bool:
    """Return whether a header Host has an address, or a name of this machine, on which a site is at ``host``.

    Whoever owns another name could lead it here, to have foreign pages read.
    """
    machine = socket.gethostname().lower()
    try:
        name = urlsplit(f"//{header}").hostname or ""
        return name in (host.lower(), "localhost", machine, f"{machine}.local") or bool(ip_address(name))
    except ValueError:
        return False


class _Handler(BaseHTTPRequestHandler):
    """Handler of GET and HEAD requests."""

    server: ReplayServer
    protocol_version = "HTTP/1.1"
    timeout = 60.0  # s until an idle connection is closed
    common_headers: ClassVar[dict[str, str]] = {
        "Content-Security-Policy": POLICY,
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Cache-Control": "no-cache",
    }

    def do_GET(self) -> None:
        path, _, query = self.path.partition("?")
        if not is_own_name(self.headers.get("Host", ""), self.server.host):
            self._answer(400, Content(PLAIN, b"this is not the name of this site\n"))
        elif path == "/" and "url=" not in query:
            self._redirect(query)
        elif (found := self.server.content.get("/index.html" if path == "/" else path)) is None:
            self._answer(404, Content(PLAIN, b"there is no such page\n"))
        else:
            self._answer(200, found)

    do_HEAD = do_GET  # noqa: N815

    def _redirect(self, query: str) -> None:
        """Redirect to the viewer with the recording's URL, which must be absolute."""
        options = {"url": f"http://{self.headers['Host']}{RECORDING}", **VIEWER_OPTIONS}
        place = f"/?{urlencode(options)}" + (f"&{query}" if query else "")
        self._answer(302, Content(PLAIN, b""), {"Location": place})

    def _answer(self, status: int, content: Content, more: Mapping[str, str] | None = None) -> None:
        self.send_response(status)
        own = {"Content-Type": content.media_type, "Content-Length": str(len(content.body))}
        for name, value in (self.common_headers | own | dict(more or {})).items():
            self.send_header(name, value)
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content.body)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the base class names it
        """Log nothing, because the command has already printed the URL."""


def viewer_files() -> dict[str, bytes]:
    """Return the files of the web viewer inside the installed Rerun package, by their paths.

    Rerun delivers them only by HTTP, so its own server runs for a moment on the loopback interface. A
    temporary configuration disables its usage analytics.

    Raises:
        ViewError: Rerun is not installed, or does not deliver the files.
    """
    program, port = str(_program()), _free_port()
    # Given the URL of a recording, Rerun starts no other service beside the viewer.
    recording = f"http://{LOOPBACK}:{port}{RECORDING}"
    command = [program, "--serve-web", "--bind", LOOPBACK, "--web-viewer-port", str(port), recording]
    with TemporaryDirectory(prefix="wildscav-viewer-") as folder:
        own = os.environ | dict.fromkeys(("HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME"), folder)
        silent: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": own}
        subprocess.run([program, "analytics", "disable"], check=False, **silent)
        with subprocess.Popen(command, **silent) as server:
            try:
                return {path: _fetch(server, f"http://{LOOPBACK}:{port}{path}") for path in TYPES}
            finally:
                server.kill()


def _program() -> Path:
    """Return Rerun's executable, because killing the script of that name would leave it running."""
    try:
        import rerun_cli  # type: ignore[import-untyped]
    except ImportError:
        raise ViewError("the web viewer needs Rerun: pip install 'wildscav[view]'") from None
    candidates = [Path(folder) / name for folder in rerun_cli.__path__ for name in ("rerun", "rerun.exe")]
    for program in candidates:
        if program.is_file():
            return program
    raise ViewError(f"the installed Rerun has no executable at {candidates[0]}")


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return int(probe.getsockname()[1])


def _fetch(server: "subprocess.Popen[bytes]", address: str) -> bytes:
    """Return the response of a URL whose server may still be starting.

    Raises:
        ViewError: The server has exited, or does not answer in time.
    """
    browser, end = build_opener(ProxyHandler({})), time.monotonic() + PATIENCE
    while True:
        try:
            with browser.open(address, timeout=PATIENCE) as answer:
                return bytes(answer.read())
        except (URLError, HTTPException, OSError) as error:
            if server.poll() is not None or time.monotonic() > end:
                raise ViewError(f"the installed Rerun does not deliver its web viewer: {error}") from None
        time.sleep(0.05)
