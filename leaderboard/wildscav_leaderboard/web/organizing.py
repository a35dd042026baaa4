"""The organizers' pages: what waits and what went wrong, and the forms of privileged acts."""

import re
from typing import Annotated, Any, NamedTuple

from fastapi import APIRouter, Depends, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from pydantic import BaseModel
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.requests import CurrentDatabase, Now, Number, OrganizingBrowser, check_form
from wildscav_leaderboard.accounts.service import Caller, invitations
from wildscav_leaderboard.api.organizing import account_rows
from wildscav_leaderboard.api.season import announcement_views
from wildscav_leaderboard.api.submissions import submission_views
from wildscav_leaderboard.api.teams import team_rows
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.organizing.acts import ACTS, given_up
from wildscav_leaderboard.organizing.status import audit_entries, nodes, status
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.queue import queue
from wildscav_leaderboard.submissions.service import list_submissions
from wildscav_leaderboard.web.rendering import page

router = APIRouter()
ENTRIES = 100  # of a list that are shown at once
OWN_PAGE = re.compile(r"/organizer(?:/[a-z-]+)?")


class Notice(NamedTuple):
    """What a page says about the form that was sent last."""

    error: str = ""
    shown_once: tuple[str, str] | None = None  # what it is, and what it says
    status: int = 200


def overview(
    request: Request,
    caller: OrganizingBrowser,
    database: CurrentDatabase,
    now: Now,
    state: str = "",
    before: Number | None = None,
) -> HTMLResponse:
    """Show one of the organizers' pages; of lists, what comes before an entry, and is in a state."""
    return _show(request, caller, database, now, request.url.path, state=state, before=before)


for part in ("", "/submissions", "/teams", "/people", "/announcements", "/audit-log"):
    router.get(f"/organizer{part}", response_class=HTMLResponse)(overview)


def _show(
    request: Request,
    caller: Caller,
    database: Database,
    now: Now,
    path: str,
    notice: Notice = Notice(),  # noqa: B008 (immutable)
    *,
    state: str = "",
    before: int | None = None,
) -> HTMLResponse:
    """Return one of the organizers' pages."""
    template = f"organizer{path.removeprefix('/organizer').replace('/', '_').replace('-', '_')}.html"
    with database.reading() as session:
        return page(
            request,
            template,
            caller,
            notice.status,
            one=status(session, request.app.state.season, now),
            here=path,
            acts=ACTS,
            frozen=season_state.is_frozen(session),
            notice=notice,
            state=state,
            **_content(session, caller, now, path, state, before),
        )


def _content(
    session: Session, caller: Caller, now: Now, path: str, state: str, before: int | None
) -> dict[str, Any]:
    """Return what a page shows besides the season's status."""
    match path.rpartition("/")[2]:
        case "submissions":
            chosen = (state,) if state in states.STATES else ()
            found = list_submissions(session, in_states=chosen, before=before, limit=ENTRIES)
            again = {*given_up(session, found), *(one.id for one in found if one.state == states.FAILED)}
            views = submission_views(session, found, caller, now)
            return {"found": views, "again": again, "most": ENTRIES}
        case "teams":
            return {"teams": team_rows(session)}
        case "people":
            return {"invitations": invitations(session), "accounts": account_rows(session)}
        case "announcements":
            return {"announcements": announcement_views(session)}
        case "audit-log":
            return {"entries": audit_entries(session, before, ENTRIES), "most": ENTRIES}
    return {"waiting": submission_views(session, queue(session), caller, now), "nodes": nodes(session)}


async def sent_fields(request: Request) -> dict[str, str]:
    """Return what a form sends."""
    form = await request.form(max_files=0)
    return {name: text for name, text in form.items() if isinstance(text, str)}


@router.post("/organizer", response_class=HTMLResponse)
def act(
    request: Request,
    caller: OrganizingBrowser,
    database: CurrentDatabase,
    now: Now,
    sent: Annotated[dict[str, str], Depends(sent_fields)],
) -> Response:
    """Do what a form asks for, and show the page that it was on."""
    check_form(caller, sent.get("csrf", ""))
    here = sent["here"] if OWN_PAGE.fullmatch(sent.get("here", "")) else "/organizer"
    try:
        wanted = ACTS.get(sent.get("act", ""))
        if wanted is None:
            raise RefusalError("the form asks for something that is not known: load the page again")
        arguments = wanted.read({name: sent[name].strip() for name in wanted.on_forms if name in sent})
        with database.writing() as session:
            doing = Doing(session, request.app.state.season, caller.account.name, now)
            result = wanted.do(doing, arguments)
    except RefusalError as error:
        return _show(request, caller, database, now, here, Notice(str(error), status=error.status))
    if not isinstance(result, BaseModel):
        return RedirectResponse(here, 303)
    *named, secret = result.model_dump().values()
    return _show(request, caller, database, now, here, Notice("", (" ".join([wanted.title, *named]), secret)))
