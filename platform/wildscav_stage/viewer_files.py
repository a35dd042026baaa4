"""The viewer: the script and the style sheet that draw matches in a browser, as ``viewer/`` is built."""

import gzip
import hashlib
from functools import lru_cache
from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, Router

from wildscav.errors import UserError

FOLDER = Path(__file__).parent / "static" / "viewer"
SCRIPT, STYLE, LICENSES = "viewer.js", "viewer.css", "viewer.js.LEGAL.txt"
PATH = "/stage"  # where a site has these files
TO_BUILD = "run make viewer in the checkout"
TYPES = {".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8"}
KEPT = "public, max-age=31536000, immutable"  # at an address that names the version


def viewer_file(name: str) -> bytes:
    """Return the content of a file of the viewer.

    Raises:
        UserError: The viewer is not built.
    """
    path = FOLDER / name
    try:
        status = path.stat()
        return _content(path, status.st_mtime_ns, status.st_size)
    except FileNotFoundError:
        raise UserError(f"the viewer is not built, as {path} is missing: {TO_BUILD}") from None


def viewer_addresses(root: str = "/") -> tuple[str, str]:
    """Return where the script and the style sheet are below a root, which changes when the files do.

    Raises:
        UserError: The viewer is not built.
    """
    folder = f"{root}{PATH[1:]}"
    return f"{folder}/{versioned(SCRIPT)}", f"{folder}/{versioned(STYLE)}"


def versioned(name: str) -> str:
    """Return the name of a file, and its version as a query.

    Raises:
        UserError: The viewer is not built.
    """
    return f"{name}?v={digest(viewer_file(name))}"


def viewer_routes() -> Router:
    """Return what answers for the viewer's files, to be mounted at ``PATH``."""
    return Router([Route("/{name}", _answer)])


def _answer(request: Request) -> Response:
    name = request.path_params["name"]
    if name not in {path.name for path in FOLDER.glob("*")}:
        raise HTTPException(404)
    content = viewer_file(name)
    is_kept = request.query_params.get("v") == digest(content)
    headers = {"Cache-Control": KEPT if is_kept else "no-cache", "Vary": "Accept-Encoding"}
    if "gzip" in request.headers.get("accept-encoding", ""):
        content, headers["Content-Encoding"] = _compressed(content), "gzip"
    media_type = TYPES.get(Path(name).suffix, "text/plain; charset=utf-8")
    return Response(content, media_type=media_type, headers=headers)


@lru_cache(8)
def _content(path: Path, _changed: int, _size: int) -> bytes:
    """Return the content of a file, which is read again when it has changed."""
    return path.read_bytes()


@lru_cache(8)
def digest(content: bytes) -> str:
    """Return what names a content."""
    return hashlib.blake2b(content, digest_size=8).hexdigest()


@lru_cache(8)
def _compressed(content: bytes) -> bytes:
    return gzip.compress(content, 9, mtime=0)
