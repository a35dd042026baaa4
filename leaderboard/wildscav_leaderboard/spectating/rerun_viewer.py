"""The Rerun web viewer, served from the installed package, so that pages show replays without any other host.

Its files are taken from the package once for each version, compressed, and kept in a folder. They have a
policy of their own: the viewer runs WebAssembly and a script inside its page, and it may ask this host alone.
"""

import contextlib
import fcntl
import gzip
import shutil
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Annotated
from urllib.parse import urlencode

from fastapi import APIRouter, Header, HTTPException
from starlette.responses import FileResponse, Response

from wildscav.errors import UserError
from wildscav_engine.view import ViewError
from wildscav_engine.view.web import POLICY, TYPES, viewer_files

VERSION = version("rerun-sdk")
PATH = f"/viewer/{VERSION}/"  # of the viewer's page
COMPRESSED = ".gz"
LEVEL = 9  # of gzip: once for each version
HEADERS = {
    "Content-Security-Policy": f"{POLICY}; frame-ancestors 'self'; base-uri 'none'; form-action 'none'",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "SAMEORIGIN",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "public, max-age=31536000, immutable",  # the version is in the path
    "Vary": "Accept-Encoding",
}


def address_of(recording: str) -> str:
    """Return the address of the viewer's page with a recording in it, for a frame.

    Args:
        recording: The absolute URL of the ``.rrd`` file.
    """
    options = {"url": recording, "hide_welcome_screen": "", "persist": "0", "renderer": "webgl"}
    return f"{PATH}?{urlencode(options)}"


def router(folder: Path) -> APIRouter:
    """Return the routes of the viewer.

    Args:
        folder: Where its files are kept, one folder for each version.
    """
    routes = APIRouter(include_in_schema=False)

    @routes.get("/viewer/{viewer}/{name:path}")
    def viewer_file(viewer: str, name: str, accept_encoding: Annotated[str, Header()] = "") -> Response:
        """Answer with one file of the viewer."""
        path = f"/{name or 'index.html'}"
        if viewer != VERSION or path not in TYPES:
            raise HTTPException(404, "There is no such file of the viewer.")
        return _answer(kept_viewer(folder) / f"{path[1:]}{COMPRESSED}", TYPES[path], accept_encoding)

    return routes


def _answer(file: Path, media_type: str, accept_encoding: str) -> Response:
    """Return a compressed file, or its content for those who take nothing compressed."""
    if "gzip" in accept_encoding:
        return FileResponse(file, media_type=media_type, headers={**HEADERS, "Content-Encoding": "gzip"})
    return Response(gzip.decompress(file.read_bytes()), media_type=media_type, headers=HEADERS)


def kept_viewer(folder: Path) -> Path:
    """Return the folder with the compressed files of the installed version, which is filled if it is missing.

    Raises:
        UserError: The installed Rerun does not deliver its viewer.
        OSError: The files cannot be written.
    """
    kept = folder / VERSION
    if kept.is_dir():
        return kept
    with _alone(folder):
        if not kept.is_dir():
            _keep(kept)
    return kept


def _keep(kept: Path) -> None:
    """Fill a folder, which exists only when it is complete."""
    try:
        files = viewer_files()
    except ViewError as error:
        raise UserError(str(error)) from None
    part = kept.with_name(f".{kept.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    part.mkdir()
    for path, content in files.items():
        (part / f"{path[1:]}{COMPRESSED}").write_bytes(gzip.compress(content, LEVEL, mtime=0))
    part.rename(kept)


@contextlib.contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep other threads and other servers waiting that want to fill the same folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
