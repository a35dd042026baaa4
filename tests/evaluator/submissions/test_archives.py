"""Submissions as archives: good ones are unpacked, tricks are refused, and nothing is left of those."""

import gzip
import io
import os
import resource
import stat
import struct
import tarfile
import time
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
from tests.unlimited import call_here

from wildscav.system.limited_process import PROCESSOR_TIME, call_limited
from wildscav_evaluator.cache import prune
from wildscav_evaluator.submissions import archives
from wildscav_evaluator.submissions.archives import ArchiveError, unpack
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_server.hosting.manifest import SubmissionError

MANIFEST = b'name = "walker"\nversion = "1"\nentry_point = "agent:Walker"\ntracks = ["navigation"]\n'
GOOD = {"submission.toml": MANIFEST, "agent.py": b"class Walker: ...", "models/net.bin": bytes(1000)}
KINDS = ["a.zip", "a.tar.gz"]


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(archives, "call_limited", call_limited)  # which seasons' tests replace for all
    return tmp_path / "cache" / "submissions"


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unpack in this process."""
    monkeypatch.setattr(archives, "call_limited", call_here)


def pack(path: Path, files: Mapping[Any, bytes]) -> Path:
    """Pack the contents of files by their names, or by what an archive has for them."""
    if path.suffix == ".zip":
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in files.items():
                archive.writestr(name, content)
        return path
    with tarfile.open(path, "w:gz") as archive:
        for name, content in files.items():
            info = name if isinstance(name, tarfile.TarInfo) else tarfile.TarInfo(name)
            info.size = len(content)
            archive.addfile(info, io.BytesIO(content))
    return path


def special(path: Path, name: str, target: str, kind: bytes = tarfile.SYMTYPE) -> Path:
    """Pack a good submission and a link, or a file of another kind."""
    if path.suffix == ".zip":
        link = zipfile.ZipInfo(name)
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        return pack(path, {**GOOD, link: target.encode()})
    odd = tarfile.TarInfo(name)
    odd.type, odd.linkname = kind, target
    return pack(path, {odd: b"", **GOOD})


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("name", [*KINDS, "a.tgz"])
@pytest.mark.parametrize("top", ["", "./", "my-agent/"])
def test_a_good_archive_is_the_submission_that_was_packed(tmp_path: Path, name: str, top: str) -> None:
    archive = pack(tmp_path / name, {top + file: content for file, content in GOOD.items()})

    submission = load_submission(archive)

    assert submission.name == "walker"
    found = {
        str(path.relative_to(submission.folder)) for path in submission.folder.rglob("*") if path.is_file()
    }
    assert found == set(GOOD)
    assert load_submission(archive).folder == submission.folder


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("name", KINDS)
def test_what_macos_adds_beside_the_folder_that_it_packs_is_no_part_of_it(tmp_path: Path, name: str) -> None:
    files = {f"my-agent/{file}": content for file, content in GOOD.items()}
    plain = load_submission(pack(tmp_path / name, files))
    added = ("__MACOSX/my-agent/._agent.py", ".DS_Store", "._my-agent")

    packed = load_submission(pack(tmp_path / f"finder-{name}", files | dict.fromkeys(added, b"")))

    assert packed.digest == plain.digest


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("files", "says"),
    [
        ({}, " has no submission.toml at its top or in its single folder"),
        ({"my-agent/agent.py": b""}, " has no submission.toml at its top or in its single folder"),
        (
            {"my-agent/submission.toml": MANIFEST},
            "/submission.toml: entry_point: is 'agent:Walker', but there is no file {archive}/agent.py",
        ),
    ],
)
def test_what_is_wrong_in_an_archive_is_told_of_the_archive(
    tmp_path: Path, files: dict[str, bytes], says: str
) -> None:
    archive = pack(tmp_path / "a.zip", files)
    with pytest.raises(SubmissionError) as refused:
        load_submission(archive)
    assert str(refused.value) == f"{archive}{says.format(archive=archive)}"


def test_a_cache_keeps_what_was_used_last_and_whatever_may_be_in_use(cache: Path) -> None:
    for name, days in {"today": 0.5, "yesterday": 1.5, "last week": 7, "last month": 31}.items():
        (cache / name).mkdir(parents=True)
        (cache / name / "agent.py").write_bytes(bytes(100_000))
        used = time.time() - days * 86_400
        os.utime(cache / name, (used, used))

    prune(cache)
    assert {path.name for path in cache.iterdir()} == {"today", "yesterday", "last week"}
    prune(cache, largest=250_000)
    assert {path.name for path in cache.iterdir()} == {"today", "yesterday"}
    prune(cache, largest=1)
    assert {path.name for path in cache.iterdir()} == {"today"}


def test_an_archive_that_was_asked_for_again_counts_as_used(tmp_path: Path, cache: Path) -> None:
    archive = pack(tmp_path / "a.zip", GOOD)
    folder = unpack(archive)
    os.utime(folder, (0.0, 0.0))
    unpack(archive)
    unpack(pack(tmp_path / "b.zip", {**GOOD, "more.py": b""}))
    assert folder.is_dir()
    assert len(list(cache.iterdir())) == 2


@pytest.mark.usefixtures("here")
def test_an_archive_and_the_folder_in_it_have_one_digest(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    for name, content in GOOD.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)

    digests = {load_submission(pack(tmp_path / name, GOOD)).digest for name in KINDS}

    assert digests == {load_submission(folder).digest}


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("../evil.py", "leads out"),
        ("models/../../evil.py", "leads out"),
        ("/tmp/wildscav-evil.py", "leads out"),  # noqa: S108
        ("C:/evil.py", "leads out"),
        ("..\\evil.py", "is not allowed: a name must be printable"),
        ("a\nb.py", "is not allowed: a name must be printable"),
        ("\x1b[2Jclear.py", "is not allowed: a name must be printable"),
        ("x" * 300, "is not allowed: a name must be printable"),
        ("d/" * 30 + "deep.py", "folders deep"),
        ("AGENT.py", "is there twice"),
        ("agent.py/more.py", "cannot be unpacked"),
    ],
)
def test_names_stay_inside_and_are_names(
    tmp_path: Path, cache: Path, kind: str, name: str, says: str
) -> None:
    archive = pack(tmp_path / kind, {**GOOD, name: b"evil"})

    with pytest.raises(ArchiveError, match=says) as caught:
        unpack(archive)

    assert str(caught.value).isprintable()
    assert list(cache.iterdir()) == []
    assert not (tmp_path / "cache" / "evil.py").exists()
    assert not Path("/tmp/wildscav-evil.py").exists()  # noqa: S108


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("target", ["/etc/passwd", "../../outside", "agent.py"])
@pytest.mark.parametrize(
    ("name", "kind", "says"),
    [
        ("a.zip", tarfile.SYMTYPE, "a link"),
        ("a.tar.gz", tarfile.SYMTYPE, "a link"),
        ("a.tar.gz", tarfile.LNKTYPE, "a link"),
        ("a.tar.gz", tarfile.FIFOTYPE, "a special file"),
        ("a.tar.gz", tarfile.CHRTYPE, "a special file"),
    ],
)
def test_links_and_special_files_are_refused(
    tmp_path: Path, cache: Path, name: str, kind: bytes, says: str, target: str
) -> None:
    with pytest.raises(ArchiveError, match=f"'odd' is {says}: an archive may have plain files and folders"):
        unpack(special(tmp_path / name, "odd", target, kind))

    assert list(cache.iterdir()) == []


@pytest.mark.parametrize("kind", KINDS)
def test_bombs_end_where_they_become_too_large(tmp_path: Path, cache: Path, kind: str) -> None:
    archive = pack(tmp_path / kind, {**GOOD, "zeros": bytes(20 << 20)})
    assert archive.stat().st_size < 100_000  # a hundredth of what it becomes

    with pytest.raises(ArchiveError, match="unpacks to more than 1 MiB"):
        unpack(archive, largest=1 << 20)

    assert list(cache.iterdir()) == []


def test_a_zip_that_lies_about_sizes_is_found_out(tmp_path: Path, cache: Path) -> None:
    archive = pack(tmp_path / "a.zip", {**GOOD, "zeros": bytes(1 << 20)})
    lying = archive.read_bytes().replace((1 << 20).to_bytes(4, "little"), (10).to_bytes(4, "little"))
    archive.write_bytes(lying)

    with pytest.raises(ArchiveError, match="cannot be unpacked"):
        unpack(archive)

    assert list(cache.iterdir()) == []


@pytest.mark.parametrize("kind", KINDS)
def test_too_many_entries_are_refused(tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archives, "MAX_ENTRIES", 10)

    with pytest.raises(ArchiveError, match="more than 10 entries"):
        unpack(pack(tmp_path / kind, {f"{number}.py": b"" for number in range(11)}))


def test_an_archive_that_is_too_large_is_not_even_opened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archives, "LARGEST", 100)

    with pytest.raises(ArchiveError, match="may have 0 MiB at most"):
        unpack(pack(tmp_path / "a.zip", GOOD))


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "spoil", [lambda _: b"", lambda _: b"no archive", lambda good: good[: len(good) // 2]]
)
def test_what_is_no_archive_is_said_to_be_none(
    tmp_path: Path, cache: Path, kind: str, spoil: Callable[[bytes], bytes]
) -> None:
    archive = pack(tmp_path / kind, GOOD)
    archive.write_bytes(spoil(archive.read_bytes()))

    with pytest.raises((ArchiveError, SubmissionError)):
        load_submission(archive)

    assert not cache.exists() or [path for path in cache.iterdir() if path.name.startswith("unpacking")] == []


def test_a_file_that_is_no_archive_by_its_name_is_told_what_is(tmp_path: Path) -> None:
    (tmp_path / "agent.rar").write_bytes(b"Rar!")

    with pytest.raises(SubmissionError, match=r"or one as \.zip, \.tar\.gz, \.tgz"):
        load_submission(tmp_path / "agent.rar")


def gnu_long_name(path: Path) -> None:
    """A name of 3 GiB, which a reader of headers takes into its memory."""
    with gzip.open(path, "wb", compresslevel=1) as file:
        header = tarfile.TarInfo("././@LongLink")
        header.type, header.size = tarfile.GNUTYPE_LONGNAME, 3 << 30
        file.write(header.tobuf(tarfile.GNU_FORMAT))
        for _ in range(640):
            file.write(b"a" * (1 << 20))


def pax_digits(path: Path) -> None:
    """A pax header of 256 KiB of digits: hardly any bytes, and minutes for the standard library."""
    with gzip.open(path, "wb") as file:
        header = tarfile.TarInfo("pax")
        content = b"1" * (256 << 10)
        header.type, header.size = tarfile.XHDTYPE, len(content)
        file.write(header.tobuf(tarfile.USTAR_FORMAT) + content)


def many_entries(path: Path) -> None:
    """A directory of a million entries, which is read as a whole."""
    entry = struct.pack("<4s4B4HL2L5H2L", b"PK\x01\x02", *[0] * 11, 1, *[0] * 6) + b"a"
    content = entry * 1_000_000
    end = struct.pack("<4s4H2LH", b"PK\x05\x06", 0, 0, 65_535, 65_535, len(content), 0, 0)
    path.write_bytes(content + end)


def damaged_lzma(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_LZMA) as archive:
        archive.writestr("agent.py", bytes(range(256)) * 100)
    content = bytearray(path.read_bytes())
    content[60:120] = bytes(60)
    path.write_bytes(content)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("a.tar.gz", gnu_long_name),
        ("a.tgz", pax_digits),
        ("a.zip", many_entries),
        ("a.zip", damaged_lzma),
    ],
)
def test_what_would_eat_time_or_memory_is_refused_in_a_line(
    tmp_path: Path, cache: Path, name: str, make: Callable[[Path], None]
) -> None:
    make(tmp_path / name)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with pytest.raises(ArchiveError) as caught:
        unpack(tmp_path / name)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert "\n" not in str(caught.value)
    assert used.ru_utime + used.ru_stime - before.ru_utime - before.ru_stime < PROCESSOR_TIME + 5
    assert list(cache.iterdir()) == []
