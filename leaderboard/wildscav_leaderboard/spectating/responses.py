"""HTTP answers with files that are rendered from records."""

from collections.abc import Mapping

from starlette.responses import FileResponse, JSONResponse, Response

from wildscav_leaderboard.spectating.render_cache import Progress

STATUS = {"waiting": 202, "rendering": 202, "failed": 503}
POLL_AFTER = "1"  # s
NO_STORE = {"Cache-Control": "no-store"}
# Browsers ask for a video piece by piece, and begin anew if its tag or its time changes. The time of a file
# in the cache says when it was used last, so a constant one is told.
LONG_AGO = "Thu, 01 Jan 1970 00:00:00 GMT"
# A record never changes, and neither does what is rendered from it.
KEPT = {"Cache-Control": "private, max-age=86400", "X-Content-Type-Options": "nosniff"}
FORMS: Mapping[str, tuple[str, dict[str, str]]] = {
    "trails": ("application/json", {"Content-Encoding": "gzip"}),
    "overview": ("image/webp", {}),
    "replay": ("application/octet-stream", {}),
    "poster": ("image/jpeg", {}),
    "video": ("video/mp4", {}),
}


def file_response(product: str, progress: Progress) -> Response:
    """Return a file, or how far it is: 202 while it is rendered, 503 if that failed, with state and detail.

    Args:
        product: A name in ``PRODUCTS``.
        progress: How far its file is.
    """
    if progress.path is None:
        return progress_response(progress)
    media_type, headers = FORMS[product]
    tag = {"ETag": f'"{progress.path.name}"', "Last-Modified": LONG_AGO}
    return FileResponse(progress.path, media_type=media_type, headers={**KEPT, **tag, **headers})


def progress_response(progress: Progress) -> Response:
    """Return how far a file is, for a page that polls: 200 once it is ready."""
    headers = NO_STORE if progress.state in ("ready", "failed") else {**NO_STORE, "Retry-After": POLL_AFTER}
    content = {"state": progress.state, "detail": progress.detail}
    return JSONResponse(content, STATUS.get(progress.state, 200), headers)
