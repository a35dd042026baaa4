"""Forms of other sites: they are refused, even where nobody is logged in and a form has no token.

Without that, another site could log people into an account of its own, and they would submit for it.
"""

from typing import Annotated
from urllib.parse import urlsplit

from fastapi import Depends, Request
from starlette.requests import HTTPConnection

from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import ForbiddenError

OWN_SITE = ("same-origin", "none")  # what browsers say of our own pages' forms


def check_same_site(request: Request) -> None:
    """Check that a form was not sent by a page of another site.

    Browsers say where a form comes from. Over TLS and on one's own machine they do so in a header of its own,
    and otherwise they name the page's origin; programs say nothing, and have nobody else's cookies.

    Raises:
        ForbiddenError: It was.
    """
    site = request.headers.get("sec-fetch-site")
    origin = request.headers.get("origin")
    if site is not None:
        is_own = site in OWN_SITE
    elif origin is not None:
        is_own = is_own_origin(request, origin)
    else:
        is_own = True
    if not is_own:
        raise ForbiddenError("this form is from another site: open the page here, and send it again")


def is_own_origin(connection: HTTPConnection, origin: str) -> bool:
    """Return whether an origin, as browsers name it, is that of this site."""
    season: Season = connection.app.state.season
    own = {connection.headers.get("host", ""), urlsplit(season.settings.web.url or "").netloc} - {""}
    return urlsplit(origin).netloc in own


SameSite = Annotated[None, Depends(check_same_site)]
