"""A season as a folder of files, which any web server can serve, and `wildscav verify` reads as it is."""

import csv
import hashlib
import io
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy.orm import Session

from wildscav.terminal.console import counted
from wildscav_evaluator.output.layout import SEASON_FILE
from wildscav_leaderboard.boards.documents import BoardDocument, LadderRow, Row, SuiteRow
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import MatchResult
from wildscav_leaderboard.publishing.documents import (
    BoardFile,
    Line,
    PublishedBoard,
    PublishedMatch,
    PublishedSeason,
)
from wildscav_leaderboard.publishing.service import Addresses, board_lines, published_season
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season, place_for
from wildscav_leaderboard.seasons.in_force import in_force

PLACE = tuple(Row.model_fields)
RATING = tuple(name for name in LadderRow.model_fields if name not in PLACE)
STATISTICS = ("mean", "std", "low", "high")
MATCH = ("match", "kind", "number", "at", "record", "void")
SEAT = ("seat", "entrant", "submission", "status", "fault")


def board_table(board: BoardDocument) -> str:
    """Return a board as CSV, a row for each team."""
    metrics = [one.name for one in board.metrics]
    if board.mode == "ladder":
        columns: tuple[str, ...] = RATING
    else:
        columns = tuple(f"{name} {statistic}" for name in metrics for statistic in STATISTICS)
    rows = [[*(getattr(row, name) for name in PLACE), *_values(row, metrics)] for row in board.rows]
    return _text((*PLACE, *columns), rows)


def _values(row: Row, metrics: Sequence[str]) -> list[object]:
    if isinstance(row, LadderRow):
        return [getattr(row, name) for name in RATING]
    if not isinstance(row, SuiteRow) or not row.metrics:
        return []
    return [getattr(row.metrics[name], statistic) for name in metrics for statistic in STATISTICS]


def matches_table(matches: Sequence[PublishedMatch]) -> str:
    """Return matches as CSV, a row for each seat of an entrant."""
    names = list(dict.fromkeys(name for match in matches for seat in match.seats for name in seat.metrics))
    rows: list[list[object]] = []
    for match in matches:
        own: list[object] = [match.id, match.kind, match.number, match.at, match.record, match.void]
        rows += [
            [*own, *(getattr(seat, name) for name in SEAT), *(seat.metrics.get(name) for name in names)]
            for seat in match.seats
        ] or [own]
    return _text((*MATCH, *SEAT, *names), rows)


def _text(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    output = io.StringIO()
    writer = csv.writer(output, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(value) for value in row] for row in rows)
    return output.getvalue()


def _cell(value: object) -> object:
    """Return a cell that no spreadsheet takes for a formula: people give names to teams and submissions."""
    return f"'{value}" if isinstance(value, str) and value[:1] in "=+-@" and value else value


TEXT = """# {title}

What is published of the season `{name}` ({opens:%Y-%m-%d} to {closes:%Y-%m-%d}), as files. {state}

`wildscav verify FOLDER` (or the address at which these files are served) checks all of it: it plays the
records again, and computes every score, interval and rating anew. `sha256sum --check SHA256SUMS` shows
whether a file was damaged on its way.

| file | |
|---|---|
| `season.json` | the season: its dates, its tracks, the commitments to its secrets{secret} |
| `boards/TRACK.json`, `boards/TRACK.csv` | the board of a track{season} |
| `tracks/TRACK.ndjson` | for audits: the board, its submissions, and the matches that count, one a line |
| `matches/TRACK.csv` | those matches for spreadsheets, a row for each seat |
| `records/…/MATCH.wsr` | a match: `wildscav verify` plays it again, `wildscav replay` shows it |
| `SHA256SUMS` | a digest of each file |

| track | ranked by | suite | rounds |
|---|---|---|---|
{tracks}

The secrets from which the seeds of all matches follow, and of those that decide the season, have the SHA-256

    {commitment}  secret.txt
    {final}  final-secret.txt

{boards}, {matches}, {records}{hidden}.
"""


def readme(season: PublishedSeason, boards: int, matches: int, records: int, hidden: int) -> str:
    """Return the page, in Markdown.

    Args:
        hidden: The number of records that cannot be published yet.
    """
    tracks = [
        f"| {track.name} | {'a ladder' if track.mode == 'ladder' else 'the suite'} | `{track.suite}` "
        f"| {'' if track.mode == 'ladder' else track.rounds} |"
        for track in season.tracks
    ]
    return TEXT.format(
        title=_plain(season.title),
        name=season.name,
        opens=season.opens,
        closes=season.closes,
        state="It is final." if season.finalized else "The season is not finalized yet.",
        season="; `TRACK-season`: as it was before final matches decided it" if season.finalized else "",
        secret="" if season.secret.secret is None else ", and the secrets themselves",
        tracks="\n".join(tracks),
        commitment=season.secret.commitment,
        final=season.final_secret.commitment,
        boards=counted(boards, "board"),
        matches=counted(matches, "match"),
        records=counted(records, "record"),
        hidden=f"; {hidden:,} more are hidden until the secret is opened" if hidden else "",
    )


def _plain(text: str) -> str:
    """Return a text that Markdown shows as it is."""
    return "".join(f"\\{letter}" if letter in "\\`*_{}[]()#+-.!|<>" else letter for letter in text)


IN_FOLDER = Addresses(
    lines={"public": "tracks/{track}.ndjson", "season": "tracks/{track}-season.ndjson"},
    shown={"public": "boards/{track}.json", "season": "boards/{track}-season.json"},
    records="records/{thousand}/{match}.wsr",
)
SUMS_FILE, README_FILE = "SHA256SUMS", "README.md"


@dataclass(frozen=True)
class Exported:
    """What was exported."""

    folder: Path
    boards: int
    matches: int
    records: int
    hidden: int  # records that cannot be published yet


def export(season: Season, database: Database, folder: Path) -> Exported:
    """Write everything that is published of a season into a new folder, whole or not at all.

    Args:
        folder: The folder, which must be missing or empty.

    Raises:
        UserError: The folder has something in it, or cannot be written, or a record is missing.
    """
    folder = folder.absolute()
    with place_for(folder, "the season cannot be exported") as place:
        made = place / "export"
        made.mkdir()
        with database.reading() as session:
            counts = _write(session, in_force(session, season), made)
        _write_sums(made)
        made.rename(folder)
    return Exported(folder, *counts)


def _write(session: Session, season: Season, folder: Path) -> tuple[int, int, int, int]:
    """Write all files; return the numbers of boards, matches, records, and hidden records."""
    document = published_season(session, season, IN_FOLDER)
    _write_text(folder / SEASON_FILE, document.model_dump_json(indent=1) + "\n")
    count, matches = 0, dict[int, PublishedMatch]()
    for board in document.boards:
        file = _write_board(session, season, folder, board)
        count += file.board is not None
        matches |= {match.id: match for match in file.matches}
    shown = [match for match in matches.values() if match.record is not None and match.hidden is None]
    for match in shown:
        _copy_record(session, season, folder, match)
    for track in document.tracks:
        if track.suite_file is not None:
            _write_text(folder / "suites" / f"{track.name}.toml", track.suite_file)
    for name, one in ((SECRET_FILE, document.secret), (FINAL_SECRET_FILE, document.final_secret)):
        if one.secret is not None:
            (folder / name).write_bytes(bytes.fromhex(one.secret))
    hidden = sum(match.hidden is not None for match in matches.values())
    counts = count, len(matches), len(shown), hidden
    _write_text(folder / README_FILE, readme(document, *counts))
    return counts


def _write_board(session: Session, season: Season, folder: Path, board: PublishedBoard) -> BoardFile:
    """Write the files of a board: for audits, and for people and their spreadsheets."""
    lines: list[Line] = []
    path = folder / board.lines
    path.parent.mkdir(exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as output:
        for line in board_lines(session, season, board.track, board.audience):
            output.write(line.text())
            lines.append(line)
    file = BoardFile.of(lines)
    if file.board is not None:
        shown = folder / board.shown
        _write_text(shown, file.board.model_dump_json(indent=1) + "\n")
        _write_text(shown.with_suffix(".csv"), board_table(file.board))
        _write_text(folder / "matches" / f"{board.label}.csv", matches_table(file.matches))
    return file


def record_address(template: str, match: int) -> str:
    """Return the address of a match's record."""
    return template.replace("{match}", str(match)).replace("{thousand}", f"{match // 1000:04d}")


def _copy_record(session: Session, season: Season, folder: Path, match: PublishedMatch) -> None:
    result = session.get_one(MatchResult, match.id)
    source = season.match_folder(match.id) / str(result.row["record"])
    target = folder / record_address(IN_FOLDER.records, match.id)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)
    session.expunge(result)


def _write_text(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, "utf-8", newline="")


def _write_sums(folder: Path) -> None:
    """Write the sums of all files, as ``sha256sum --check`` reads them."""
    lines = []
    for name in sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()):
        with (folder / name).open("rb") as file:
            lines.append(f"{hashlib.file_digest(file, 'sha256').hexdigest()}  {name}\n")
    _write_text(folder / SUMS_FILE, "".join(lines))
