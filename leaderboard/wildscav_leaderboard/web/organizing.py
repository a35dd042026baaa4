"""The organizers' pages: what waits and what went wrong, and the forms of privileged acts."""

import re
from typing import Annotated, Any, NamedTuple

from fastapi import APIRouter, Form, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.requests import CurrentDatabase, Now, OrganizingBrowser, check_form
from wildscav_leaderboard.accounts.models import COMPETITOR, ORGANIZER
from wildscav_leaderboard.accounts.passwords import hashed, new_password
from wildscav_leaderboard.accounts.service import Caller, invitations
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.organizing import service
from wildscav_leaderboard.organizing.status import audit_entries, nodes, status
from wildscav_leaderboard.presentation.organizing import account_rows
from wildscav_leaderboard.presentation.people import team_rows
from wildscav_leaderboard.presentation.season import announcement_views
from wildscav_leaderboard.presentation.submissions import submission_views
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.listing import list_submissions
from wildscav_leaderboard.submissions.queue import queue
from wildscav_leaderboard.web.rendering import page

router = APIRouter()
Text = Annotated[str, Form(max_length=6000)]
Before = Annotated[int | None, Query(ge=1, le=2**53)]
ENTRIES = 100  # of a list that are shown at once
OWN_PAGE = re.compile(r"/organizer(?:/[a-z-]+)?")


class Notice(NamedTuple):
    """What a page says about the form that was sent last."""

    error: str = ""
    shown_once: tuple[str, str] | None = None  # what it is, and what it says
    status: int = 200


@router.get("/organizer", response_class=HTMLResponse)
def overview(
    request: Request, caller: OrganizingBrowser, database: CurrentDatabase, now: Now
) -> HTMLResponse:
    """Show how the season is doing."""
    return _show(request, caller, database, now, "/organizer")


@router.get("/organizer/submissions", response_class=HTMLResponse)
def submissions(
    request: Request,
    caller: OrganizingBrowser,
    database: CurrentDatabase,
    now: Now,
    state: str = "",
    before: Before = None,
) -> HTMLResponse:
    """Show all submissions, or those in one state."""
    return _show(request, caller, database, now, "/organizer/submissions", state=state, before=before)


@router.get("/organizer/teams", response_class=HTMLResponse)
def teams(request: Request, caller: OrganizingBrowser, database: CurrentDatabase, now: Now) -> HTMLResponse:
    """Show all teams."""
    return _show(request, caller, database, now, "/organizer/teams")


@router.get("/organizer/people", response_class=HTMLResponse)
def people(request: Request, caller: OrganizingBrowser, database: CurrentDatabase, now: Now) -> HTMLResponse:
    """Show the invitations and the accounts, and the forms for them."""
    return _show(request, caller, database, now, "/organizer/people")


@router.get("/organizer/announcements", response_class=HTMLResponse)
def announcements(
    request: Request, caller: OrganizingBrowser, database: CurrentDatabase, now: Now
) -> HTMLResponse:
    """Show what was announced, and the form for more."""
    return _show(request, caller, database, now, "/organizer/announcements")


@router.get("/organizer/audit-log", response_class=HTMLResponse)
def audit_log(
    request: Request, caller: OrganizingBrowser, database: CurrentDatabase, now: Now, before: Before = None
) -> HTMLResponse:
    """Show every privileged act, the latest first."""
    return _show(request, caller, database, now, "/organizer/audit-log", before=before)


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
            found = list_submissions(session, states=chosen, before=before, limit=ENTRIES)
            return {"found": submission_views(session, found, caller, now), "most": ENTRIES}
        case "teams":
            return {"teams": team_rows(session)}
        case "people":
            roles = (COMPETITOR, ORGANIZER)
            return {"invitations": invitations(session), "roles": roles, "accounts": account_rows(session)}
        case "announcements":
            return {"announcements": announcement_views(session)}
        case "audit-log":
            return {"entries": audit_entries(session, before, ENTRIES), "most": ENTRIES}
    return {"waiting": submission_views(session, queue(session), caller, now), "nodes": nodes(session)}


@router.post("/organizer", response_class=HTMLResponse)
def act(
    request: Request,
    caller: OrganizingBrowser,
    database: CurrentDatabase,
    now: Now,
    csrf: Text,
    act: Text,
    value: Text = "",
    text: Text = "",
    role: Text = COMPETITOR,
    uses: Text = "1",
    here: Text = "/organizer",
) -> Response:
    """Do what a form asks for, and show the page that it was on."""
    check_form(caller, csrf)
    here = here if OWN_PAGE.fullmatch(here) else "/organizer"
    actor = caller.account.name
    try:
        if act == "invite":
            times = None if uses == "any" else _number(uses)
            with database.writing() as session:
                key = service.invite(session, actor, value.strip(), now, role=_role(role), uses=times)
            return _show(request, caller, database, now, here, Notice("", ("Key of the invitation", key)))
        if act == "reset-password":
            shown = _new_password(database, actor, value.strip(), now)
            return _show(request, caller, database, now, here, Notice("", shown))
        with database.writing() as session:
            _do(session, actor, act, value.strip(), text.strip(), now)
    except RefusalError as error:
        return _show(request, caller, database, now, here, Notice(str(error), status=error.status))
    return RedirectResponse(here, 303)


def _new_password(database: Database, actor: str, name: str, now: Now) -> tuple[str, str]:
    """Give an account a new password, and return what is shown of it once."""
    password = new_password()
    secret = hashed(password)  # takes a while, so before the transaction
    with database.writing() as session:
        service.reset_password(session, actor, name, secret, now)
    return f"New password of {name}", password


def _do(session: Session, actor: str, act: str, value: str, text: str, now: Now) -> None:
    """Do a privileged act."""
    match act:
        case "pause":
            service.pause(session, actor, text, now)
        case "resume":
            service.resume(session, actor, now)
        case "announce":
            service.announce(session, actor, value, text, now)
        case "rerun":
            service.rerun(session, actor, _number(value), now)
        case "disqualify-submission":
            service.disqualify_submission(session, actor, _number(value), text, now)
        case "disqualify-team":
            service.disqualify_team(session, actor, value, text, now)
        case "disable-account":
            service.disable_account(session, actor, value, text, now)
        case "enable-account":
            service.enable_account(session, actor, value, now)
        case "freeze":
            service.freeze(session, actor, now)
        case _:
            raise RefusalError("the form asks for something that is not known: load the page again")


def _role(text: str) -> str:
    return ORGANIZER if text == ORGANIZER else COMPETITOR


def _number(text: str) -> int:
    return int(text) if text.isascii() and text.isdigit() and len(text) < 16 else 0
