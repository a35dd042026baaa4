"""A season that was played fairly holds; whatever is changed in what is published is found and named."""

import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.leaderboard.auditing.conftest import Run
from tests.leaderboard.auditing.tampering import Published, numbers, replace_at
from tests.leaderboard.played_seasons import TEAMS

from wildscav.errors import UserError
from wildscav_engine.record import read_record
from wildscav_engine.record.format import save
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.suites.seeds import commitment_of, new_secret
from wildscav_leaderboard.auditing.audit import Audit
from wildscav_leaderboard.auditing.record_checks import Wanted
from wildscav_leaderboard.matches.record_files import record_digest

SUITE_MATCHES, FINAL_MATCHES, LADDER_MATCHES = 18, 12, 6


def test_a_season_that_was_played_fairly_holds_and_everything_is_checked(
    opened: Published, audit: Run
) -> None:
    report = audit(opened)

    assert report.findings == []
    counts = {(check.track, check.what): check.checked for check in report.checks}
    assert not any(check.unchecked for check in report.checks)
    for track, count, rows in (
        ("navigation", FINAL_MATCHES, 2),
        ("navigation-season", SUITE_MATCHES, 3),
        ("battle", LADDER_MATCHES, 4),
        ("battle-season", LADDER_MATCHES, 4),
    ):
        assert counts[track, "rows of the board"] == rows
        for what in ("results of matches", "records", "records played again", "matches drawn by the secret"):
            assert counts[track, what] == count, what


def test_before_the_secrets_are_opened_the_rest_is_listed_with_the_reason(
    hidden: Published, audit: Run
) -> None:
    report = audit(hidden)

    assert report.findings == []
    checks = {(check.track, check.what): check for check in report.checks}
    records = checks["navigation", "records"]
    assert (records.checked, list(records.unchecked.values())) == (0, [SUITE_MATCHES])
    assert "hidden until the season's secret is opened" in next(iter(records.unchecked))
    for what, count in (("rows of the board", 3), ("results of matches", SUITE_MATCHES)):
        assert checks["navigation", what].checked == 0
        assert checks["navigation", what].unchecked == {next(iter(records.unchecked)): count}
    assert checks["battle", "records played again"].checked == LADDER_MATCHES
    assert checks["battle", "seats of the ladder's games"].checked == LADDER_MATCHES
    assert checks["battle", "matches drawn by the secret"].checked == 0
    assert checks[None, "secrets and their commitments"].unchecked == {"the secret is not opened yet": 2}


def test_of_a_hidden_suite_nothing_is_published_but_which_records_there_are(
    hidden: Published, audit: Run
) -> None:
    told = {"id", "kind", "number", "judging", "submission", "record", "hidden"}
    for match in hidden.matches("navigation"):
        empty = {name: value for name, value in match.items() if name not in told}
        assert not any(empty.values()), empty
        assert match["record"]
    hidden.change_matches("navigation", lambda matches: matches.pop(2))
    (finding,) = audit(hidden, track="navigation", records=0).findings
    assert (finding.field, finding.published, finding.expected) == ("matches", 6, 5)


def row(board: dict[str, Any], team: str) -> dict[str, Any]:
    return next(one for one in board["rows"] if one["team"] == team)


def leader(board: dict[str, Any]) -> dict[str, Any]:
    return next(one for one in board["rows"] if one["team"])


def inside(document: dict[str, Any], path: list[str]) -> dict[str, Any]:
    for name in path:
        document = document[name]
    return document


@pytest.mark.parametrize(
    ("track", "field", "by"),
    [
        ("navigation", "metrics.time.mean", 1e-9),
        ("navigation", "rank", 1),
        ("battle", "rating", 0.01),
        ("battle", "wins", 1),
    ],
)
def test_a_wrong_digit_on_a_board_is_found_and_its_row_and_field_are_named(
    opened: Published, audit: Run, track: str, field: str, by: float
) -> None:
    """Also if the same digit is wrong wherever the board is shown."""
    *path, last = field.split(".")
    whose = leader(opened.board(track))
    team, number = whose["team"], whose["submission"]
    right = inside(whose, path)[last]

    def change(board: dict[str, Any]) -> None:
        inside(row(board, team), path)[last] = right + by

    opened.change_board(track, change)

    (finding,) = audit(opened, records=0).findings

    assert (finding.track, finding.team, finding.submission, finding.field) == (track, team, number, field)
    assert (finding.published, finding.expected) == (right + by, right)
    assert str(finding) == (
        f"{track}, team {team}, submission {number}: {field} is published as {right + by}, must be {right}"
    )


def count_twice(matches: list[dict[str, Any]]) -> None:
    matches.append({**matches[-1], "id": matches[-1]["id"] + 1})


def renumber(matches: list[dict[str, Any]]) -> None:
    matches[0]["id"], matches[1]["id"] = matches[1]["id"], matches[0]["id"]
    matches[0], matches[1] = matches[1], matches[0]


Change = Callable[[Published, str, Callable[[Any], object]], None]
CHANGED: list[tuple[Change, str, Callable[[Any], object], str]] = [  # where, how, and the only finding
    (
        Published.change_shown,
        "battle",
        lambda board: row(board, "foxes").update(rating=2600.0),
        r"team foxes, submission 1: rating is published as 2600\.0, .* \(in the board that is shown\)",
    ),
    (Published.change_board, "battle", lambda board: board["rows"].reverse(), "the rows are in the order"),
    (
        Published.change_lines,
        "battle",
        lambda lines: lines.pop(),
        r"battle: tracks/battle\.ndjson is not valid: it has no end",
    ),
    (
        Published.change_matches,
        "battle",
        lambda found: found[2]["metrics"].update(kills=7.0),
        r"metrics\.kills is published as 7\.0",
    ),
]


@pytest.mark.parametrize(("change", "track", "how", "says"), CHANGED)
def test_what_is_changed_is_found_and_nothing_else(
    opened: Published, audit: Run, change: Change, track: str, how: Callable[[Any], object], says: str
) -> None:
    change(opened, track, how)

    (finding,) = audit(opened, records=0).findings
    assert re.search(says, str(finding))


SPOILED: list[tuple[Change, str, Callable[[Any], object], str]] = [  # where, how, and one of the findings
    (Published.change_board, "navigation", lambda board: board["rows"].pop(0), "has no row, and should"),
    (
        Published.change_matches,
        "battle",
        lambda matches: matches.pop(2),
        "the ladder's match number 2 is missing",
    ),
    (
        Published.change_matches,
        "battle",
        lambda matches: matches.insert(0, matches.pop(1)),
        "not in the order in",
    ),
    (Published.change_matches, "battle", renumber, "as another one is"),
    (Published.change_matches, "navigation", count_twice, "the submission has two results of match number"),
]


@pytest.mark.parametrize(("change", "track", "how", "says"), SPOILED)
def test_what_is_changed_is_found_with_what_follows_from_it(
    opened: Published, audit: Run, change: Change, track: str, how: Callable[[Any], object], says: str
) -> None:
    change(opened, track, how)

    assert [one for one in audit(opened, records=0).findings if says in str(one)]


def test_a_match_that_two_boards_of_a_track_count_differently_is_found(opened: Published, audit: Run) -> None:
    other = opened.matches("battle")[0]
    changed = {**other, "metrics": {**other["metrics"], "kills": 9.0}}
    opened.change_matches("battle-season", lambda matches: matches.append(changed))

    said = f"battle-season, match {other['id']}: another board of the track counts it differently"
    assert said in [str(one) for one in audit(opened, track="battle", records=0).findings]


def test_a_board_that_is_not_published_at_all_is_found(opened: Published, audit: Run) -> None:
    def leave_out(season: dict[str, Any]) -> None:
        season["boards"] = [one for one in season["boards"] if one["track"] != "battle"]

    opened.change_season(leave_out)
    (finding,) = audit(opened, records=0).findings
    assert str(finding) == "battle: its board is not published for audits"


def test_files_are_those_of_the_sums_and_records_of_their_digests(opened: Published, audit: Run) -> None:
    match = opened.matches("battle")[1]["id"]
    path = opened.record(match)
    content = bytearray(path.read_bytes())
    content[20] ^= 1
    path.write_bytes(content)
    opened.resum()
    (opened.folder / "boards/battle.csv").write_text("rank\n")
    (opened.folder / "more.txt").write_text("?")

    first, second, *others = audit(opened, track="battle", replay=0).findings
    assert str(first) == "boards/battle.csv is not the file that SHA256SUMS names"
    assert str(second) == "more.txt is not in SHA256SUMS"
    assert {(one.track, one.match) for one in others} == {("battle", match)}
    assert all("its record has the digest" in str(one) for one in others)


def test_a_result_that_is_not_its_records_is_found_and_so_is_the_board_that_follows_from_it(
    opened: Published, audit: Run
) -> None:
    def cheat(matches: list[dict[str, Any]]) -> None:
        match = matches[0]
        match["seats"][0]["metrics"]["time"] = match["metrics"]["time"] = 0.5

    opened.change_matches("navigation", cheat)
    assert {one.field for one in audit(opened, records=0).findings} >= {"metrics.time.mean"}, (
        "without records, the board and the result contradict each other"
    )
    report = audit(opened)
    (finding,) = report.findings
    first = opened.matches("navigation")[0]
    assert (finding.submission, finding.match) == (first["submission"], first["id"])
    assert (finding.team, finding.field) == (TEAMS[first["submission"] - 1], "seats.0.metrics.time")
    assert finding.published == 0.5


def test_a_record_that_is_another_matchs_is_found_even_if_its_digest_fits(
    opened: Published, audit: Run
) -> None:
    first, second = opened.matches("navigation")[:2]
    opened.record(first["id"]).write_bytes(opened.record(second["id"]).read_bytes())
    opened.change_matches("navigation", lambda matches: matches[0].update(record=second["record"]))

    findings = audit(opened, track="navigation", replay=0).findings
    assert {one.match for one in findings if one.match is not None} == {first["id"]}
    assert any("it is not match number 0 that the secret gives" in str(one) for one in findings)


@pytest.mark.parametrize("track", ["navigation", "battle", "battle-season"])
def test_a_private_seed_that_does_not_follow_from_the_secret_is_found(
    opened: Published, audit: Run, track: str
) -> None:
    match = opened.matches(track)[0]
    seat = next(one for one in match["seats"] if one["submission"])
    path = opened.record(match["id"])
    record = read_record(path)
    seeds = [12345 if number == seat["seat"] else seed for number, seed in enumerate(record.seeds)]
    save(replace(record, seeds=tuple(seeds)), path)
    opened.change_matches(track, lambda matches: matches[0].update(record=record_digest(path.read_bytes())))

    (finding,) = audit(opened, track=track.partition("-")[0]).findings
    assert (finding.track, finding.match, finding.submission) == (track, match["id"], seat["submission"])
    assert f"seat {seat['seat']} was told a private seed that does not follow" in str(finding)


def test_private_seeds_follow_from_the_content_of_the_submission(opened: Published, audit: Run) -> None:
    submission = opened.lines("navigation-season")[1]["submission"]
    digest = {"digest": "ab" * 16}
    opened.change_lines("navigation-season", lambda lines: lines[1]["submission"].update(digest))
    findings = audit(opened, track="navigation", replay=0).findings
    assert [(one.team, "private seed" in one.problem) for one in findings] == [(submission["team"], True)] * 6


def test_a_secret_that_was_swapped_does_not_fit_its_commitment(opened: Published, audit: Run) -> None:
    other = new_secret()
    opened.change_season(lambda season: season["secret"].update(secret=other.hex()))

    report = audit(opened, replay=0)
    (finding,) = report.findings
    assert (finding.field, finding.expected) == ("commitment", commitment_of(other))
    drawn = {one.track: one for one in report.checks if one.what == "matches drawn by the secret"}
    wrong = {"the opened secret is not the one of the commitment": LADDER_MATCHES}
    assert (drawn["battle-season"].checked, drawn["battle-season"].unchecked) == (0, wrong)
    assert drawn["navigation"].checked == FINAL_MATCHES, "they come from the other secret"


def test_maps_that_another_secret_gives_are_found_even_if_its_commitment_was_swapped_too(
    opened: Published, audit: Run
) -> None:
    other = new_secret()
    was = opened.board("battle-season")["conditions"]["commitment"]
    swapped = {"secret": other.hex(), "commitment": commitment_of(other)}
    opened.change_season(lambda season: season["secret"].update(swapped))

    found = [str(one) for one in audit(opened, track="battle", replay=0).findings]
    assert any(was in one and "conditions.commitment" in one for one in found)
    assert sum("of the ladder's match number" in one for one in found) == LADDER_MATCHES


def test_a_commitment_that_was_noted_earlier_must_still_be_the_published_one(
    opened: Published, audit: Run
) -> None:
    noted = opened.board("battle")["conditions"]["commitment"]
    assert audit(opened, records=0, commitment=noted).holds
    (finding,) = audit(opened, records=0, commitment="ab" * 32).findings
    assert finding.field == "commitment"


def test_a_match_that_is_left_out_is_found_on_the_board(opened: Published, audit: Run) -> None:
    team = TEAMS[opened.matches("navigation")[2]["submission"] - 1]
    opened.change_matches("navigation", lambda matches: matches.pop(2))

    findings = audit(opened, track="navigation", replay=0).findings
    assert {(team, "matches"), (team, "rank")} <= {(one.team, one.field) for one in findings}


def test_the_board_of_before_the_final_matches_is_audited_too(opened: Published, audit: Run) -> None:
    right = row(opened.board("navigation-season"), "hares")["metrics"]["time"]["mean"]
    opened.change_lines(
        "navigation-season", lambda lines: row(lines[0]["board"], "hares")["metrics"]["time"].update(mean=1.0)
    )
    findings = audit(opened, records=0).findings
    assert {(one.track, one.team, one.field) for one in findings} == {
        ("navigation-season", "hares", "metrics.time.mean")
    }
    assert {(one.published, one.expected) for one in findings} == {(1.0, right), (right, 1.0)}


def test_some_records_are_chosen_by_chance(opened: Published, audit: Run) -> None:
    report = audit(opened, track="navigation", records=4, replay=2)
    checks = {check.what: check for check in report.checks}
    assert report.holds
    assert (checks["records"].checked, checks["records played again"].checked) == (4, 2)
    assert checks["records"].unchecked == {
        "nobody asked for it (--download, --resimulate)": SUITE_MATCHES - 4
    }


def test_a_track_that_the_season_does_not_have_is_an_error_of_usage(opened: Published, audit: Run) -> None:
    with pytest.raises(UserError, match="the season has no track 'royale'; it has navigation, battle"):
        audit(opened, track="royale")


def test_a_folder_of_something_else_is_refused(audit: Run, tmp_path: Any) -> None:
    with pytest.raises(UserError, match="name the address of a season, or a folder that"):
        audit(tmp_path)


@pytest.fixture(scope="module")
def published(after_opening: Path, tmp_path_factory: pytest.TempPathFactory) -> Published:
    folder = tmp_path_factory.mktemp("numbers") / "season"
    return Published(Path(shutil.copytree(after_opening, folder)))


@pytest.mark.parametrize("track", ["navigation", "battle"])
@settings(max_examples=20)
@given(data=st.data(), by=st.sampled_from((1, -1, 0.01, -1e-6, 1e-9, 1000.0)))
def test_whichever_number_of_a_board_is_changed_it_is_found(
    published: Published, track: str, data: st.DataObject, by: float
) -> None:
    right = published.board(track)
    path = data.draw(st.sampled_from(list(numbers(right))))

    def put_back(board: dict[str, Any]) -> None:
        board.clear()
        board.update(right)

    published.change_board(track, lambda board: replace_at(board, path, lambda number: number + by))
    try:
        audit = Audit(Wanted(track=track, records=0), LocalExecutor(1), published.folder)
        report = audit.run(str(published))
    finally:
        published.change_board(track, put_back)
    assert not report.holds, path
    assert all(one.track == track for one in report.findings)
