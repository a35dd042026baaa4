"""The matches that were played at a table, for whoever was told of their secrets, as long as it is open."""

from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from wildscav.errors import UserError
from wildscav_stage.watching.match_page import FILES, Scene, Shown, match_page, scene_of, title_of
from wildscav_stage.watching.match_site import file_response

if TYPE_CHECKING:
    from wildscav_stage.playing.table import Table

SCENES = 20  # that are kept
ROOT = "../"  # from the page of a match to the site's own
PAGE = "/matches/{secret}"
UNSHOWN = "Its record cannot be read, or not be played again here."  # guests are not told where it lies


class Replays:
    """The pages of these matches in 3D, and at home their records."""

    def __init__(self, table: "Table") -> None:
        self._table = table
        self._scenes: dict[str, Future[Scene]] = {}  # by the secrets of matches, from the first to the last
        # One at a time: a match that is being played needs the other processors.
        self._worker = ThreadPoolExecutor(1, "replays")
        self.routes = [
            Route(PAGE, self._show),
            Route(f"{PAGE}/record", self._send_record),
            Route(f"{PAGE}/{{name}}", self._send_file),
        ]

    def _asked_for(self, request: Request) -> tuple[str, Path]:
        """Return the secret and the record of the match that a request is about.

        Raises:
            HTTPException: There is none.
        """
        secret: str = request.path_params["secret"]
        record = self._table.records.get(secret)
        if record is None or not record.exists():
            raise HTTPException(404)
        return secret, record

    def _show(self, request: Request) -> Response:
        secret, path = self._asked_for(request)
        return HTMLResponse(match_page(Shown(title_of(path), secret), root=ROOT))

    async def _send_file(self, request: Request) -> Response:
        """Send a file of a match, or 202 while it is being made."""
        (secret, path), name = self._asked_for(request), request.path_params["name"]
        if name not in FILES:
            raise HTTPException(404)
        scene = self._scene(secret, path)
        if not scene.done():
            return JSONResponse({}, 202)
        try:
            return file_response(scene.result(), name)
        except UserError:
            return JSONResponse({"error": UNSHOWN}, 500)

    def _scene(self, secret: str, path: Path) -> Future[Scene]:
        """Return what a match is drawn from, made once; of too many, the first ones are forgotten."""
        if secret not in self._scenes:
            if len(self._scenes) >= SCENES:
                self._scenes.pop(next(iter(self._scenes))).cancel()
            self._scenes[secret] = self._worker.submit(scene_of, path)
        return self._scenes[secret]

    async def _send_record(self, request: Request) -> Response:
        _, path = self._asked_for(request)
        if not self._table.at_home:
            raise HTTPException(404)
        return FileResponse(path, media_type="application/octet-stream", filename=path.name)
