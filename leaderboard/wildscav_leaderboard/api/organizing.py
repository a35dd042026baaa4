"""Routes of the organizers: how the season is doing, and privileged acts."""

from typing import Annotated

from fastapi import APIRouter, Depends, Query
from fastapi import Path as PathParameter
from sqlalchemy import select

from wildscav_leaderboard.access.requests import (
    CurrentDatabase,
    CurrentSeason,
    Now,
    OrganizingProgram,
    Reading,
    organizing_program,
)
from wildscav_leaderboard.accounts.passwords import hashed, new_password
from wildscav_leaderboard.organizing import service
from wildscav_leaderboard.presentation.documents import AuditEntryView, KeyView, Reason, SubmissionView
from wildscav_leaderboard.presentation.organizing import (
    AccountRow,
    NewAnnouncement,
    NewInvitation,
    NewPasswordView,
    StatusView,
    account_rows,
    status_view,
)
from wildscav_leaderboard.presentation.submissions import submission_view
from wildscav_leaderboard.seasons.models import AuditEntry
from wildscav_leaderboard.submissions.service import find_submission

MOST = 200  # entries of the audit log in an answer

router = APIRouter(prefix="/organizer", tags=["organizing"], dependencies=[Depends(organizing_program)])
Number = Annotated[int, PathParameter(ge=1, le=2**53)]


@router.get("/status")
def status(season: CurrentSeason, session: Reading, now: Now) -> StatusView:
    """Return how the season is doing."""
    return status_view(session, season, now)


@router.get("/audit-log")
def audit_log(
    session: Reading,
    before: Annotated[int | None, Query(ge=1, le=2**53)] = None,
    limit: Annotated[int, Query(ge=1, le=MOST)] = MOST,
) -> list[AuditEntryView]:
    """List the privileged acts, the latest first."""
    wanted = select(AuditEntry).order_by(AuditEntry.id.desc()).limit(limit)
    if before is not None:
        wanted = wanted.where(AuditEntry.id < before)
    return [AuditEntryView.model_validate(one) for one in session.scalars(wanted)]


@router.post("/pause", status_code=204)
def pause(why: Reason, caller: OrganizingProgram, database: CurrentDatabase, now: Now) -> None:
    """Let nothing new be begun; what is being played is finished."""
    with database.writing() as session:
        service.pause(session, caller.account.name, why.reason, now)


@router.post("/resume", status_code=204)
def resume(caller: OrganizingProgram, database: CurrentDatabase, now: Now) -> None:
    """Let a paused season go on."""
    with database.writing() as session:
        service.resume(session, caller.account.name, now)


@router.post("/freeze", status_code=204)
def freeze(caller: OrganizingProgram, database: CurrentDatabase, now: Now) -> None:
    """Keep the public boards as they are until the season is over."""
    with database.writing() as session:
        service.freeze(session, caller.account.name, now)


@router.post("/announcements", status_code=204)
def announce(new: NewAnnouncement, caller: OrganizingProgram, database: CurrentDatabase, now: Now) -> None:
    """Show a text on the season's page."""
    with database.writing() as session:
        service.announce(session, caller.account.name, new.title, new.text, now)


@router.post("/invitations", status_code=201)
def invite(new: NewInvitation, caller: OrganizingProgram, database: CurrentDatabase, now: Now) -> KeyView:
    """Make an invitation; its key is shown once."""
    with database.writing() as session:
        key = service.invite(session, caller.account.name, new.label, now, role=new.role, uses=new.uses)
        return KeyView(key=key)


@router.get("/accounts")
def accounts(session: Reading) -> list[AccountRow]:
    """List all accounts, by their names."""
    return account_rows(session)


@router.post("/accounts/{name}/disable", status_code=204)
def disable_account(
    name: str, why: Reason, caller: OrganizingProgram, database: CurrentDatabase, now: Now
) -> None:
    """Let an account no longer be used; its owner is told the reason."""
    with database.writing() as session:
        service.disable_account(session, caller.account.name, name, why.reason, now)


@router.post("/accounts/{name}/enable", status_code=204)
def enable_account(name: str, caller: OrganizingProgram, database: CurrentDatabase, now: Now) -> None:
    """Let a disabled account be used again."""
    with database.writing() as session:
        service.enable_account(session, caller.account.name, name, now)


@router.post("/accounts/{name}/password")
def reset_password(
    name: str, caller: OrganizingProgram, database: CurrentDatabase, now: Now
) -> NewPasswordView:
    """Give an account a new password, which is shown once; it is logged out everywhere."""
    password = new_password()
    secret = hashed(password)  # takes a while, so before the transaction
    with database.writing() as session:
        service.reset_password(session, caller.account.name, name, secret, now)
    return NewPasswordView(name=name, password=password)


@router.post("/submissions/{number}/rerun")
def rerun(
    number: Number, caller: OrganizingProgram, season: CurrentSeason, database: CurrentDatabase, now: Now
) -> SubmissionView:
    """Try a failed submission again, or play the matches again that were given up."""
    with database.writing() as session:
        service.rerun(session, caller.account.name, number, now)
        return submission_view(session, season, find_submission(session, number), caller, now)


@router.post("/submissions/{number}/disqualify")
def disqualify_submission(
    number: Number,
    why: Reason,
    caller: OrganizingProgram,
    season: CurrentSeason,
    database: CurrentDatabase,
    now: Now,
) -> SubmissionView:
    """Take a submission off all boards; everyone sees the reason."""
    with database.writing() as session:
        service.disqualify_submission(session, caller.account.name, number, why.reason, now)
        return submission_view(session, season, find_submission(session, number), caller, now)


@router.post("/teams/{name}/disqualify", status_code=204)
def disqualify_team(
    name: str, why: Reason, caller: OrganizingProgram, database: CurrentDatabase, now: Now
) -> None:
    """Take a team off all boards; everyone sees the reason."""
    with database.writing() as session:
        service.disqualify_team(session, caller.account.name, name, why.reason, now)
