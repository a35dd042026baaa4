"""What organizers see and do, and the routes."""

import inspect
from collections.abc import Callable
from datetime import datetime
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query
from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_leaderboard.access.requests import (
    CurrentDatabase,
    CurrentSeason,
    Now,
    Number,
    OrganizingProgram,
    Reading,
    organizing_program,
)
from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.api.documents import AuditEntryView, SubmissionView, View
from wildscav_leaderboard.api.submissions import submission_view
from wildscav_leaderboard.organizing.acts import ACTS
from wildscav_leaderboard.organizing.arguments import NewKey
from wildscav_leaderboard.organizing.status import StatusView, audit_entries
from wildscav_leaderboard.organizing.status import status as status_of
from wildscav_leaderboard.seasons.acts import Act, Doing
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Member, Team


class AccountRow(View):
    """An account, as organizers see it."""

    name: str
    role: str
    team: str | None
    created: datetime
    disabled: str | None  # why it may not be used


def account_rows(session: Session) -> list[AccountRow]:
    """Return all accounts, by their names."""
    wanted = (
        select(Account, Team.name)
        .outerjoin(Member, Member.account_id == Account.id)
        .outerjoin(Team, Team.id == Member.team_id)
        .order_by(Account.name)
    )
    return [AccountRow.about(one, team=team) for one, team in session.execute(wanted)]


MAX_ENTRIES = 200  # entries of the audit log in an answer

router = APIRouter(prefix="/organizer", tags=["organizing"], dependencies=[Depends(organizing_program)])


@router.get("/status")
def status(season: CurrentSeason, session: Reading, now: Now) -> StatusView:
    """Return how the season is doing."""
    return status_of(session, season, now)


@router.get("/audit-log")
def audit_log(
    session: Reading,
    before: Number | None = None,
    limit: Annotated[int, Query(ge=1, le=MAX_ENTRIES)] = MAX_ENTRIES,
) -> list[AuditEntryView]:
    """List the privileged acts, the latest first."""
    return [AuditEntryView.model_validate(one) for one in audit_entries(session, before, limit)]


@router.get("/accounts")
def accounts(session: Reading) -> list[AccountRow]:
    """List all accounts, by their names."""
    return account_rows(session)


def _route(act: Act) -> Callable[..., Any]:
    """Return the function of an act's route: the path and a document in the body have the arguments."""
    in_body = act.model(set(act.on_forms) - set(act.in_path))

    def do(
        caller: OrganizingProgram, season: CurrentSeason, database: CurrentDatabase, now: Now, **given: Any
    ) -> Any:
        body = given.pop("body", None)
        arguments = act.read({**given, **(body.model_dump() if body is not None else {})})
        with database.writing() as session:
            result = act.do(Doing(session, season, caller.account.name, now), arguments)
            if isinstance(result, Submission):
                return submission_view(session, season, result, caller, now)
        return result

    common = [one for one in inspect.signature(do).parameters.values() if one.kind != one.VAR_KEYWORD]
    taken = [(name, act.parameters[name].annotation) for name in act.in_path]
    taken += [("body", in_body)] if in_body.model_fields else []
    named = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=one) for name, one in taken]
    do.__signature__ = inspect.Signature([*common, *named])  # type: ignore[attr-defined]
    do.__name__, do.__doc__ = act.effect.__name__, act.help
    return do


for one in ACTS.values():
    if one.path:
        view = SubmissionView if one.returns is Submission else one.returns
        code = 204 if view is None else 201 if view is NewKey else 200
        router.add_api_route(one.path, _route(one), methods=["POST"], status_code=code, response_model=view)
