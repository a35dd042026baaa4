"""The matches that were played at a table, for everybody who has one of its links, as long as it is open."""

import threading
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, Response
from starlette.routing import Route

from wildscav.errors import UserError
from wildscav_stage.watching.match_page import FILES, Scene, Shown, match_page, scene_of, title_of
from wildscav_stage.watching.match_site import file_response

if TYPE_CHECKING:
    from wildscav_stage.playing.links import Links
    from wildscav_stage.playing.table import Table

SCENES = 2  # that are kept
ROOT = "../../../"  # from the page of a match to the site's own
PAGE = "/{door}/{secret}/matches/{number:int}"


class Replays:
    """The pages of these matches in 3D, and at home their records.

    Args:
        table: The table.
        links: Its links.
    """

    def __init__(self, table: "Table", links: "Links") -> None:
        self._table, self._links = table, links
        self._drawing = threading.Lock()  # a page asks for two files of one match at a time
        self._scene = lru_cache(SCENES)(scene_of)
        self.routes = [
            Route(PAGE, self._show),
            Route(f"{PAGE}/record", self._send_record),
            Route(f"{PAGE}/{{name}}", self._send_file),
        ]

    def _asked_for(self, request: Request) -> Path:
        """Return the record of the match that a request is about.

        Raises:
            HTTPException: There is none, or the link is not valid.
        """
        number: int = request.path_params["number"]
        record = next(iter(self._table.records[number : number + 1]), None)
        if (
            not self._links.opens_match(request.path_params["secret"])
            or record is None
            or not record.exists()
        ):
            raise HTTPException(404)
        return record

    def _show(self, request: Request) -> Response:
        path, number = self._asked_for(request), request.path_params["number"]
        return HTMLResponse(match_page(Shown(title_of(path), str(number)), root=ROOT))

    def _send_file(self, request: Request) -> Response:
        path, name = self._asked_for(request), request.path_params["name"]
        if name not in FILES:
            raise HTTPException(404)
        try:
            with self._drawing:
                scene: Scene = self._scene(path)
        except UserError as error:
            raise HTTPException(500, str(error)) from None
        return file_response(scene, name)

    def _send_record(self, request: Request) -> Response:
        path = self._asked_for(request)
        if not self._table.at_home:
            raise HTTPException(404)
        return FileResponse(path, media_type="application/octet-stream", filename=path.name)
