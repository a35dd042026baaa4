"""Documents are read from web servers as they are: busy, broken in the middle, and not to be trusted."""

from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI, Response
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.auditing import sources
from wildscav_leaderboard.auditing.records import fetcher
from wildscav_leaderboard.auditing.sources import FolderSource, MissingError, SourceError, WebSource
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.publishing.documents import PublishedMatch

RECORD = b"a record"


class Site:
    """A server that refuses some requests, and counts them."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.busy = 0  # requests that are refused, because there were too many
        self.address = ""

    def app(self) -> FastAPI:
        app = FastAPI()

        @app.get("/records/{name}")
        def record(name: str) -> Response:
            self.asked.append(name)
            if self.busy:
                self.busy -= 1
                return Response(status_code=429, headers={"Retry-After": "0"})
            return Response(RECORD if name == "1" else b"something else")

        @app.get("/season.json")
        def season() -> dict[str, str]:
            return {}

        return app


@pytest.fixture
def site(monkeypatch: pytest.MonkeyPatch) -> Iterator[Site]:
    monkeypatch.setattr(sources, "PAUSE", 0.01)
    site = Site()
    with served(site.app()) as address:
        site.address = f"{address}/season.json"
        yield site


@pytest.fixture
def source(site: Site) -> Iterator[WebSource]:
    with httpx.Client() as client:
        yield WebSource(site.address, client)


def published(number: int, content: bytes) -> PublishedMatch:
    return PublishedMatch(
        id=number, kind="ladder", number=0, submission=None, record=record_digest(content), record_size=8
    )


def test_a_record_is_downloaded_once_and_kept(site: Site, source: WebSource, tmp_path: Path) -> None:
    fetch = fetcher(source, "records/{match}", tmp_path)
    assert fetch(published(1, RECORD)).content == RECORD
    assert fetch(published(1, RECORD)).content == RECORD
    assert site.asked == ["1"]


def test_a_record_that_was_damaged_in_the_cache_is_downloaded_again(
    site: Site, source: WebSource, tmp_path: Path
) -> None:
    fetch = fetcher(source, "records/{match}", tmp_path)
    fetch(published(1, RECORD))
    (kept,) = (path for path in tmp_path.rglob("*") if path.is_file())
    kept.write_bytes(b"half")
    assert fetch(published(1, RECORD)).content == RECORD
    assert site.asked == ["1", "1"]


def test_a_record_that_is_not_the_published_one_is_not_kept(source: WebSource, tmp_path: Path) -> None:
    found = fetcher(source, "records/{match}", tmp_path)(published(2, RECORD))
    assert "its record has the digest" in found.fault
    assert not any(tmp_path.iterdir())


def test_a_busy_server_is_asked_again(site: Site, source: WebSource) -> None:
    source.read("season.json")
    site.busy = 3
    assert source.read("records/1") == RECORD


def test_a_server_that_stays_busy_is_given_up(site: Site, source: WebSource) -> None:
    site.busy = 100
    with pytest.raises(SourceError, match="the server answers 429"):
        source.read("records/1")
    assert len(site.asked) == sources.TRIES


def test_what_is_missing_is_told_from_what_is_broken(source: WebSource) -> None:
    with pytest.raises(MissingError, match="does not exist"):
        source.read("boards/battle.json")


def test_a_document_that_is_too_large_is_not_read_to_its_end(source: WebSource) -> None:
    with pytest.raises(SourceError, match="has more than 4 bytes"):
        source.read("records/1", largest=4)


@pytest.mark.parametrize("address", ["http://192.0.2.1/records/1", "//192.0.2.1/x", "file:///etc/passwd"])
def test_no_document_leads_to_another_host(source: WebSource, address: str) -> None:
    with pytest.raises(SourceError, match="leads to another host"):
        source.read(address)


@pytest.mark.parametrize("address", ["../secret.txt", "/etc/passwd", "records/../../secret.txt"])
def test_no_document_leads_out_of_its_folder(tmp_path: Path, address: str) -> None:
    (tmp_path / "secret.txt").write_text("secret")
    (tmp_path / "season").mkdir()
    with pytest.raises(SourceError, match="leads out of the folder"):
        FolderSource(tmp_path / "season").read(address)
