"""The command line as its user meets it: in a process of its own."""

import os
import signal
import socket
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import grpc
import pytest
from tests.commands import run_command, running
from tests.platform.helpers.seats import Served, ended, host, serving, small_spec, start_agent, with_server_of

from wildscav.cli import main
from wildscav.cli.init import submission_name
from wildscav.proto.match_pb2 import GetMatchRequest, GetMatchResponse, HostMatchRequest
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav.version import __version__
from wildscav.wire.errors import reason_of
from wildscav_engine.record import read_record, write_record
from wildscav_engine.record.format import save
from wildscav_engine.tracks import TRACKS
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.match_server import MatchServer


def wildscav(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    return run_command(*arguments, cwd=cwd, columns=200)


def test_help_names_every_command_and_imports_nothing_heavy() -> None:
    code = "import sys; sys.argv = ['wildscav', '--help']\nfrom wildscav.cli.main import main\ntry: main()\n"
    code += "finally: print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0
    for name in ("init", "play", "evaluate", "leaderboard", "replay", "verify", "map", "serve"):
        assert f" {name} " in done.stdout
    heavy = {"grpc", "numba", "wildscav_engine", "pydantic", "sqlalchemy", "rerun"}
    assert not heavy & set(done.stderr.split())


def test_the_version() -> None:
    assert wildscav("--version").stdout == f"wildscav {__version__}\n"


@pytest.mark.parametrize(
    ("folder", "name"),
    [("my_first agent", "my-first-agent"), ("X", "my-agent"), ("a" * 50, "a" * 40), ("-7-", "my-agent")],
)
def test_a_folder_names_its_submission(folder: str, name: str) -> None:
    assert submission_name(folder) == name


def test_a_new_submission_plays_every_track_unchanged(tmp_path: Path) -> None:
    assert wildscav("init", tmp_path / "Fine Agent").returncode == 0
    folder = tmp_path / "Fine Agent"
    manifest = tomllib.loads((folder / "submission.toml").read_text())
    assert manifest["name"] == "fine-agent"
    assert manifest["tracks"] == ["navigation", "gathering", "battle"]

    async def play(server: MatchServer, address: str) -> None:
        for track in TRACKS:
            filled_by = ("submission", "fighter") if track in ("battle", "royale") else ("submission",)
            hosted = await host(server, small_spec(track, seconds=10.0, filled_by=filled_by))
            agent = await start_agent(manifest["entry_point"], address, hosted.tokens[0], folder)
            outcome = await hosted.finished()
            assert await ended(agent) == (0, "")
            assert outcome.seats[0].status == SeatStatus.FINISHED
            assert outcome.match.result().seats[0].walked > 5.0

    serving(tmp_path, play)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The record of a match that was served."""
    folder = tmp_path_factory.mktemp("served")
    path = folder / "match.wsrec"

    async def play(server: MatchServer, address: str) -> None:
        hosted = await host(server, small_spec("battle", filled_by=("submission", "fighter")))
        agent = await start_agent("Walker", address, hosted.tokens[0])
        outcome = await hosted.finished()
        await ended(agent)
        write_record(path, outcome.match, hosted.names)

    serving(folder, play)
    return path


def test_the_record_of_a_served_match_verifies(record: Path) -> None:
    done = wildscav("verify", record)
    assert done.returncode == 0, done.stderr
    lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
    assert lines[-3:] == ["match.wsrec holds 20 steps", "", "1 of 1 record holds"]


def test_verify_tells_good_records_from_bad_ones(record: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.wsrec"
    cut.write_bytes(record.read_bytes()[:-100])
    done = wildscav("verify", record, cut, tmp_path / "none.wsrec")
    assert done.returncode == 1
    assert "2 of 3 records do not hold" in done.stderr
    assert "1 of 3 records holds" in done.stdout
    assert (done.stdout.count(" holds "), done.stdout.count(" FAILS ")) == (1, 2)


def test_what_a_record_says_cannot_steer_the_terminal(record: Path, tmp_path: Path) -> None:
    hostile = "\x1b]0;mine\x07\x1b[2J[red]"
    save(replace(read_record(record), engine_version=hostile), tmp_path / "version.wsrec")
    save(replace(read_record(record), map_digest=hostile), tmp_path / "map\x1b[2J.wsrec")
    done = wildscav("verify", tmp_path / "version.wsrec", tmp_path / "map\x1b[2J.wsrec")
    assert done.returncode == 1
    assert "(recorded by engine \\x1b]0;mine\\x07\\x1b[2J[red]; this one is" in done.stdout
    assert not {"\x1b", "\x07"} & set(done.stdout + done.stderr)


def test_replay_writes_a_recording_and_says_how_to_open_it(
    record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("rerun")
    # As if no virtual environment were activated: otherwise the name of the command would do.
    own = Path(sys.executable).parent
    others = [folder for folder in os.environ["PATH"].split(os.pathsep) if Path(folder) != own]
    monkeypatch.setenv("PATH", os.pathsep.join(others))
    done = wildscav("replay", record, "-o", tmp_path / "match.rrd", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert f"{own / 'rerun'} {tmp_path / 'match.rrd'}" in done.stdout
    assert (tmp_path / "match.rrd").stat().st_size > 1000
    assert wildscav("replay", record, "--seat", 2).returncode == 2


@pytest.mark.parametrize("way", ["same", "link", "default"])
def test_a_replay_never_overwrites_its_record(record: Path, tmp_path: Path, way: str) -> None:
    before = record.read_bytes()
    arguments: dict[str, list[Path | str]] = {
        "same": [record, "-o", record],
        "link": [record, "-o", tmp_path / "link"],
        "default": [tmp_path / "match.rrd"],
    }
    (tmp_path / "link").symlink_to(record)
    (tmp_path / "match.rrd").hardlink_to(record)
    done = wildscav("replay", *arguments[way])
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "is the record itself" in done.stderr
    assert record.read_bytes() == (tmp_path / "match.rrd").read_bytes() == before


def test_a_match_that_cannot_be_set_up_again_is_one_clear_line(record: Path, tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    save(replace(read_record(record), map_digest="\x1b[31melsewhere"), tmp_path / "other.wsrec")
    done = wildscav("replay", tmp_path / "other.wsrec")
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert "other.wsrec: played on map \\x1b[31melsewhere" in done.stderr
    assert not (tmp_path / "other.rrd").exists()


def test_a_record_of_another_map_generator_says_so(record: Path, tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    old = replace(read_record(record), generator_version=1, engine_version="0.0.9")
    save(old, tmp_path / "old.wsr")
    for name in ("verify", "replay"):
        done = wildscav(name, tmp_path / "old.wsr")
        assert (done.returncode, done.stderr.count("\n")) == (1, 1)
        assert "played on a map of generator version 1, but this engine has" in done.stderr
        assert "play it with release 0.0.9, which made it" in done.stderr


def test_a_plug_in_that_cannot_be_imported_breaks_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Broken:
        def load(self) -> None:
            raise ValueError("it is broken")

    registered = {**main._registered(), "broken": Broken()}
    monkeypatch.setattr(main, "_registered", lambda: registered)
    for arguments, code in ((["broken", "x", "--y"], 1), (["--help"], 0)):
        monkeypatch.setattr(sys, "argv", ["wildscav", *arguments])
        with pytest.raises(SystemExit) as caught:
            main.main()
        assert caught.value.code == code
    output = capsys.readouterr()
    assert output.err == "wildscav: broken is not available: ValueError: it is broken\n"
    assert "verify" in output.out


@pytest.mark.slow
def test_serve_stops_at_ctrl_c() -> None:
    until = r"^listening on (.*)\n"
    with running("serve", "--listen", "127.0.0.1:0", "--workers", "1", until=until) as (address, process):
        assert address.startswith("127.0.0.1:")
        process.send_signal(signal.SIGINT)
        assert process.wait(120) == 0


def test_serve_says_that_a_port_is_in_use() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        address = f"127.0.0.1:{taken.getsockname()[1]}"
        done = wildscav("serve", "--listen", address)
    said = f"wildscav: cannot listen on {address}: it is in use already; choose another address\n"
    assert (done.returncode, done.stderr) == (1, said)


@with_server_of(arena=True)
async def test_the_arena_hosts_a_match_and_hands_out_its_record(served: Served, tmp_path: Path) -> None:
    spec = small_spec("gathering", filled_by=("submission", "gatherer"))
    async with grpc.aio.insecure_channel(served.address) as channel:
        arena = ArenaStub(channel)
        request = HostMatchRequest(
            spec_json=spec.model_dump_json(), sensors_json={0: '{"depth": {"width": 8, "height": 5}}'}
        )
        hosted = await arena.HostMatch(request)
        ask = GetMatchRequest(match_id=hosted.match_id)
        assert (await arena.GetMatch(ask)).state == GetMatchResponse.STATE_JOINING
        agent = await start_agent("SeesDepth", served.address, hosted.seat_tokens[0])
        assert await ended(agent) == (0, "")
        answer = await arena.GetMatch(ask, wait_for_ready=True)
        while answer.state == GetMatchResponse.STATE_PLAYING:
            answer = await arena.GetMatch(ask)
        assert answer.state == GetMatchResponse.STATE_FINISHED, answer.error
        assert [seat.filled_by for seat in answer.results] == ["submission", "gatherer"]
        assert answer.conduct[0].status == "finished"
        (tmp_path / "arena.wsrec").write_bytes(answer.record)
        assert read_record(tmp_path / "arena.wsrec").spec == spec


@with_server_of(arena=True, organizer_token="correct horse")  # noqa: S106
async def test_the_arena_asks_for_its_token_and_checks_what_it_is_given(served: Served) -> None:
    async with grpc.aio.insecure_channel(served.address) as channel:
        arena = ArenaStub(channel)

        async def reason(call: object) -> str:
            with pytest.raises(grpc.aio.AioRpcError) as caught:
                await call  # type: ignore[misc]
            return reason_of(caught.value)

        good = (("authorization", "Bearer correct horse"),)
        bad = (("authorization", "Bearer wrong horse"),)
        assert await reason(arena.GetMatch(GetMatchRequest())) == "ORGANIZER_TOKEN"
        assert await reason(arena.HostMatch(HostMatchRequest(), metadata=bad)) == "ORGANIZER_TOKEN"
        assert await reason(arena.GetMatch(GetMatchRequest(match_id="x"), metadata=good)) == "MATCH_UNKNOWN"
        fine = small_spec().model_dump_json()
        for request in (
            HostMatchRequest(spec_json="{}"),
            HostMatchRequest(spec_json="nonsense"),
            HostMatchRequest(spec_json=fine, names=["a", "b"]),
            HostMatchRequest(spec_json=fine, sensors_json={0: '{"sonar": {}}'}),
            HostMatchRequest(spec_json=fine, sensors_json={0: "7"}),
            HostMatchRequest(spec_json=fine, sensors_json={0: "[" * 100_000}),
        ):
            assert await reason(arena.HostMatch(request, metadata=good)) == "SPEC_INVALID", request
