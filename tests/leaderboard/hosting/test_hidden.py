"""What is hidden leaves the application by no route: each is read by everyone, in every state of a season.

The owner's seats in two matches, one of the suite and one of a ladder, have marks in whatever an agent can
write or time there. So has its log. Whoever may see a part must find its marks somewhere, and nobody else.
"""

import json
import pickle
import re
from contextlib import ExitStack
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import httpx
import pytest
from fastapi.routing import iter_route_contexts
from sqlalchemy import delete, select
from sqlalchemy.orm import Session
from tests.leaderboard.filled_season import COOKIE, FilledSeason
from tests.leaderboard.hosting.clients import ask, copied_database, numbers_of, serving_filled
from tests.leaderboard.hosting.route_table import TABLE
from tests.leaderboard.made_once import made_once

from wildscav.notes import note_line
from wildscav_leaderboard.access.rate_limits import Use
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, LADDER, SUITE, Match, MatchResult, MatchSeat
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.teams.models import Team

pytestmark = [pytest.mark.slow, pytest.mark.long]  # thousands of requests
ASKERS = ("visitor", "opponent", "owner", "organizer")
STATES = ("open", "frozen", "finalized")
LONG_AGO = datetime(2001, 2, 3, 4, 5, 6, tzinfo=UTC)  # when the match of the suite is said to have ended
FILES = ("record", "trails", "map", "replay", "replay.rrd", "poster.jpg", "video", "video.mp4")
FOR_ALL = ("GET /feeds/", "GET /badges/", "GET /viewer/")  # may be kept by shared caches


class Marks(NamedTuple):
    """What is written into a match, as the expressions by which it is found again, by part."""

    figure: float
    status: str
    detail: str
    latency: float
    late_steps: int
    log: str
    said: str  # to everyone who may see the record

    @property
    def parts(self) -> dict[str, str]:
        figure, milliseconds = str(int(self.figure)), f"{1000.0 * self.latency:,.1f}"
        return {
            "outcome": rf"(?<![\d.]){figure[0]},?{figure[1:]}(?!\d)|{self.status.replace('_', '[_ ]')}",
            "detail": self.detail,
            "timing": rf"\b{self.latency}|\b{re.escape(milliseconds)}\b|\b{self.late_steps}\b",
            "log": self.log,
            "said": self.said,
        }


MARKS = {
    SUITE: Marks(7717.25, "never_joined", "SUITE-DETAIL", 6.15437, 47119, "SUITE-LOG", "SUITE-SAID"),
    LADDER: Marks(8818.75, "out_of_memory", "LADDER-DETAIL", 7.26548, 48229, "LADDER-LOG", "LADDER-SAID"),
}
PATTERNS = {
    **{f"{kind} {part}": text for kind, marks in MARKS.items() for part, text in marks.parts.items()},
    f"{SUITE} time": "2001-02-03",
}
EVERYONE, TEAM, NOBODY = set(ASKERS), {"owner", "organizer"}, {"organizer"}
# Who may see each part while the season is open, while it is frozen, and when it is finalized.
ALLOWED: dict[str, tuple[set[str], set[str], set[str]]] = {
    "suite outcome": (NOBODY, NOBODY, EVERYONE),
    "suite time": (NOBODY, NOBODY, EVERYONE),
    "suite detail": (NOBODY, NOBODY, TEAM),
    "suite timing": (NOBODY, NOBODY, TEAM),
    "suite log": (NOBODY, NOBODY, TEAM),
    "suite said": (NOBODY, NOBODY, EVERYONE),
    "suite files": (NOBODY, NOBODY, EVERYONE),
    "ladder outcome": (EVERYONE, TEAM, EVERYONE),
    "ladder detail": (TEAM, TEAM, TEAM),
    "ladder timing": (TEAM, TEAM, TEAM),
    "ladder log": (TEAM, NOBODY, TEAM),
    "ladder said": (EVERYONE, NOBODY, EVERYONE),
    "ladder files": (EVERYONE, NOBODY, EVERYONE),
}


class Answer(NamedTuple):
    """What somebody was answered in a state of the season."""

    state: str
    asker: str
    route: str
    path: str
    response: httpx.Response


class Walk(NamedTuple):
    """All answers, the marked matches by kind, and the routes that are read."""

    answers: list[Answer]
    matches: dict[str, int]
    routes: set[str]


@pytest.fixture(scope="module")
def walk(hostile_season: FilledSeason, shared: Path) -> Walk:
    """The answers, which are asked for once for all processes of the tests."""
    folder = made_once(shared / "hidden", partial(_walk, hostile_season))
    walked: Walk = pickle.loads((folder / "walk").read_bytes())  # noqa: S301 (our own)
    return walked


def _walk(filled: FilledSeason, folder: Path) -> None:
    """Ask for everything in a season that is marked, and write the answers into a folder."""
    folder.mkdir()
    answers: list[Answer] = []
    with ExitStack() as stack:
        _, app, client = stack.enter_context(serving_filled(filled, renders=False))  # so that nobody waits
        routes = {
            f"GET {route.path}"
            for route in iter_route_contexts(app.routes)
            if "GET" in (getattr(route, "methods", None) or ())
        }
        copy = stack.enter_context(copied_database(app, filled, folder))
        with Database(f"sqlite:///{copy}").writing() as session:
            matches = marked(session, filled)
        for kind, number in matches.items():
            log = filled.season.match_folder(number) / "marked.log"
            log.write_text(
                note_line(0, say=MARKS[kind].log) + note_line(1, say=MARKS[kind].said, public=True)
            )
            stack.callback(log.unlink)
        paths = paths_of(routes, filled, matches)
        for state in STATES:
            with Database(f"sqlite:///{copy}").writing() as session:
                enter(session, filled, state, matches)
                session.execute(delete(Use))
            for route, path in paths:
                answers.extend(
                    Answer(state, asker, route, path, ask(client, filled, asker, "GET", path))
                    for asker in ASKERS
                )
    (folder / "walk").write_bytes(pickle.dumps(Walk(answers, matches, routes)))


def marked(session: Session, filled: FilledSeason) -> dict[str, int]:
    """Write marks into the owner's seats of a match of each kind; return the matches."""
    found = {}
    owner = filled.people["owner"].name
    for kind, marks in MARKS.items():
        seats = (
            select(MatchSeat)
            .join(Match, Match.id == MatchSeat.match_id)
            .join(Submission, Submission.id == MatchSeat.submission_id)
            .join(Team, Team.id == Submission.team_id)
            .where(Match.kind == kind, Match.state == FINISHED, Team.name == owner)
            .order_by(Match.id)
        )
        seat = session.scalars(seats).first()
        assert seat is not None
        match, result = session.get_one(Match, seat.match_id), session.get_one(MatchResult, seat.match_id)
        row: dict[str, Any] = json.loads(json.dumps(result.row))
        timing: dict[str, Any] = json.loads(json.dumps(result.timing))
        own = next(one for one in row["seats"] if one["seat"] == seat.seat)
        own |= {"status": marks.status, "fault": "agent", "detail": marks.detail, "log": "marked.log"}
        own["metrics"] = dict.fromkeys(own["metrics"], marks.figure)
        row |= {"detail": marks.detail, "metrics": dict.fromkeys(row["metrics"], marks.figure)}
        slow = next(one for one in timing["seats"] if one["seat"] == seat.seat)
        slow |= dict.fromkeys(("latency_p50", "latency_p99", "latency_max"), marks.latency)
        slow["late_steps"] = marks.late_steps
        result.row, result.timing = row, timing
        if kind == SUITE:
            match.since = LONG_AGO
        found[kind] = match.id
    return found


def enter(session: Session, filled: FilledSeason, state: str, matches: dict[str, int]) -> None:
    """Bring the season into a state, in which it stays."""
    now = datetime.now(UTC)
    if state == "frozen":  # just before the marked match of the ladder ended
        at = session.get_one(MatchResult, matches[LADDER]).at - timedelta(microseconds=1)
        season_state.freeze(session, at)
    if state == "finalized":
        number = session.get_one(Match, matches[SUITE]).group_id
        finalizing._decide(session, filled.season, {"navigation": [number]}, "boss", now)


def paths_of(routes: set[str], filled: FilledSeason, matches: dict[str, int]) -> list[tuple[str, str]]:
    """Return the paths at which each route is asked: for the marked matches, wherever it can be."""
    numbers: dict[str, Any] = {**numbers_of(filled), "own_suite": matches[SUITE], "suite": matches[SUITE]}
    found = {(line.route, line.path.format(**numbers)) for line in TABLE if line.method == "GET"}
    with filled.database.reading() as session:
        (owner,) = session.scalars(
            select(MatchSeat.submission_id).where(MatchSeat.match_id == matches[SUITE]).distinct()
        )
        seats = {
            number: session.scalars(
                select(MatchSeat.seat).filter_by(match_id=number, submission_id=owner)
            ).first()
            for number in matches.values()
        }
    for route in routes:
        path = route.partition(" ")[2]
        if "{match}" in path or path.startswith("/matches/{number}"):
            found |= {
                (
                    route,
                    re.sub(r"\{match\}|\{number\}", str(one), path).replace("{seat}", str(seats[one] or 0)),
                )
                for one in matches.values()
            }
        elif "{submission}" in path or "{number}" in path:
            filled_in = re.sub(r"\{submission\}|\{number\}", str(owner), path).replace("{track}", "battle")
            found.add((route, f"{filled_in}?track=battle"))
            found |= {(route, f"{filled_in}?track=battle&before={one + 1}") for one in matches.values()}
    lists, audited = "/api/v1/matches", "/api/v1/audit/tracks/{track}.ndjson"
    found |= {(f"GET {lists}", f"{lists}?before={one + 1}&limit=2") for one in matches.values()}
    found |= {
        (f"GET {audited}", f"{audited.format(track=track)}?audience={audience}")
        for track in ("navigation", "battle")
        for audience in ("public", "season")
    }
    return sorted(found)


def test_every_route_that_is_read_is_walked(walk: Walk) -> None:
    assert {answer.route for answer in walk.answers} == walk.routes


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("part", [part for part in ALLOWED if not part.endswith("files")])
def test_a_part_is_found_by_those_who_may_see_it_and_by_nobody_else(
    walk: Walk, part: str, state: str
) -> None:
    found: dict[str, set[str]] = {}
    for answer in walk.answers:
        if answer.state == state and re.search(PATTERNS[part], answer.response.text):
            found.setdefault(answer.asker, set()).add(answer.path)
    assert found.keys() == ALLOWED[part][STATES.index(state)], found


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("kind", MARKS)
def test_who_won_is_told_to_those_who_may_see_how_it_ended_for_everyone(
    walk: Walk, kind: str, state: str
) -> None:
    allowed = ALLOWED[f"{kind} outcome"][STATES.index(state)]
    everyone = NOBODY if allowed == TEAM else allowed  # a team that sees its own seat is not told
    path = f"/api/v1/matches/{walk.matches[kind]}"
    seen = [one for one in walk.answers if one.state == state and one.path == path]
    assert {one.asker for one in seen if one.response.json()["winner"] is not None} == everyone
    assert len(seen) == len(ASKERS)


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("kind", MARKS)
def test_files_of_a_match_are_given_to_those_who_may_see_them(walk: Walk, kind: str, state: str) -> None:
    allowed = ALLOWED[f"{kind} files"][STATES.index(state)]
    asked = {f"/api/v1/matches/{walk.matches[kind]}/{file}" for file in FILES}
    seen = [one for one in walk.answers if one.state == state and one.path in asked]
    assert len(seen) == len(ASKERS) * len(FILES)
    for answer in seen:
        refused = answer.response.status_code == 403
        assert refused == (answer.asker not in allowed), (answer.path, answer.asker)


def test_shared_caches_may_keep_only_what_is_the_same_for_everyone(walk: Walk) -> None:
    same: dict[tuple[str, str], set[bytes]] = {}
    for state, asker, route, path, response in walk.answers:
        kept = response.headers["cache-control"]
        if "public" in kept:
            assert route.startswith(FOR_ALL), path
            same.setdefault((state, path), set()).add(response.content)
        else:
            assert "private" in kept or "no-store" in kept, (path, asker)
            assert {"Cookie", "Authorization"} <= set(re.split(", *", response.headers["vary"])), path
    assert same
    assert all(len(contents) == 1 for contents in same.values())


def test_organizers_read_hidden_files_in_their_browser(hostile_season: FilledSeason) -> None:
    """Pages load files with the cookie alone."""
    path = "/api/v1/matches/{own_suite}"
    with serving_filled(hostile_season, renders=False) as site:
        record = f"{path}/record".format(**hostile_season.matches)
        got = [
            site.client.get(record, headers={"Cookie": f"{COOKIE}={hostile_season.people[asker].cookie}"})
            for asker in ("owner", "organizer")
        ]
        page = site.ask("organizer", path.removeprefix("/api/v1"))
    assert [one.status_code for one in got] == [403, 200]
    assert "data-trails" in page.text
