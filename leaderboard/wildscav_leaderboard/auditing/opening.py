"""Opening what is published: finding the season's document, and reading those of its tracks."""

import hashlib
from contextlib import ExitStack
from pathlib import Path, PurePosixPath

from pydantic import TypeAdapter, ValidationError

from wildscav.errors import UserError
from wildscav_engine.specs.validation import one_line
from wildscav_evaluator.output.layout import SEASON_FILE
from wildscav_leaderboard.auditing.report import Finding
from wildscav_leaderboard.auditing.sources import (
    FolderSource,
    MissingError,
    Source,
    SourceError,
    WebSource,
    open_client,
    web_candidates,
)
from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.publishing.documents import (
    BoardFile,
    IncompleteError,
    Line,
    PublishedBoard,
    PublishedSeason,
)
from wildscav_leaderboard.publishing.export import SUMS_FILE

BOARD: TypeAdapter[BoardDocument] = TypeAdapter(BoardDocument)


class InvalidDocumentError(UserError):
    """A document that is published is not valid."""


def open_source(place: str, stack: ExitStack) -> tuple[Source, PublishedSeason]:
    """Return where documents are read from, and the season's own.

    Args:
        place: A folder, or the address of a season's web site, or one at which an exported folder is served.

    Raises:
        UserError: There is nothing for audits.
    """
    if "://" not in place:
        folder = Path(place)
        if not (folder / SEASON_FILE).is_file():
            raise UserError(
                f"there is no {folder / SEASON_FILE}: name the address of a season, or a folder that "
                "`wildscav season export` wrote",
                exit_code=2,
            )
        source = FolderSource(folder)
        return source, _season(source, SEASON_FILE)
    client = stack.enter_context(open_client())
    error: UserError = SourceError(f"{place} is no address of a season", 2)
    for address in web_candidates(place):
        found = WebSource(address, client)
        try:
            return found, _season(found, address)
        except (MissingError, InvalidDocumentError) as problem:
            error = problem
    raise UserError(f"{place} publishes nothing for audits: {error}", exit_code=2)


def _season(source: Source, address: str) -> PublishedSeason:
    content = source.read(address)
    try:
        return PublishedSeason.model_validate_json(content)
    except ValidationError as error:
        raise InvalidDocumentError(f"{address} is no season of this version: {one_line(error)}") from None


def read_lines(source: Source, board: PublishedBoard) -> BoardFile:
    """Return a board's file.

    Raises:
        InvalidDocumentError: It is not valid.
        SourceError: It cannot be read.
    """
    address = board.lines
    lines = source.read(address).splitlines()
    number = 0
    try:
        parsed = []
        for number, line in enumerate(lines, 1):  # noqa: B007 (named in the error)
            parsed.append(Line.model_validate_json(line))
        return BoardFile.of(parsed)
    except ValidationError as error:
        raise InvalidDocumentError(f"{address}, line {number}, is not valid: {one_line(error)}") from None
    except IncompleteError as error:
        raise InvalidDocumentError(f"{address} is not valid: {error}") from None


def read_shown(source: Source, board: PublishedBoard) -> BoardDocument | None:
    """Return the board as it is shown to everyone; None if none is.

    Raises:
        InvalidDocumentError: It is not valid.
        SourceError: It cannot be read.
    """
    address = board.shown
    try:
        return BOARD.validate_json(source.read(address))
    except MissingError:
        return None
    except ValidationError as error:
        raise InvalidDocumentError(f"{address} is no board: {one_line(error)}") from None


def wrong_sums(folder: Path) -> tuple[int, list[Finding]]:
    """Compare an export's files with their sums; return how many there are, and what is wrong."""
    try:
        lines = (folder / SUMS_FILE).read_text("utf-8", "replace").splitlines()
    except OSError:
        return 0, [Finding(f"{SUMS_FILE} is missing")]
    findings, listed = [], set()
    for line in lines:
        digest, _, name = line.partition("  ")
        path = folder / name
        listed.add(name)
        if ".." in PurePosixPath(name).parts or name.startswith("/") or not path.is_file():
            findings.append(Finding(f"{name} is in {SUMS_FILE}, but missing"))
            continue
        with path.open("rb") as file:
            if hashlib.file_digest(file, "sha256").hexdigest() != digest:
                findings.append(Finding(f"{name} is not the file that {SUMS_FILE} names"))
    present = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    findings += [Finding(f"{name} is not in {SUMS_FILE}") for name in sorted(present - listed - {SUMS_FILE})]
    return len(listed), findings
