"""Matches of clients of MCP: they are waited for, and none costs the others more than its own seat."""

import asyncio
import base64
import io
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("mcp")

from mcp_types import ImageContent
from PIL import Image
from tests.platform.language.mcp_server.clients import SMALL, Player, text_of, with_clients

from wildscav.errors import UserError
from wildscav_engine.record import read_record, verify_record
from wildscav_language.mcp_server import desk, matches
from wildscav_language.mcp_server.desk import Desk
from wildscav_language.mcp_server.matches import Bounds, serving
from wildscav_language.mcp_server.requests import StartMatch
from wildscav_stage.scene.notes import notes_beside


class Played:
    """A navigation that one client has played from tools alone."""

    def __init__(self, folder: Path) -> None:
        self.begun = self.observed = self.rules = self.early = self.end = self.record = ""
        self.blob, self.picture = b"", b""
        with_clients(folder, 1, self._play)

    async def _play(self, player: Player) -> None:
        self.begun = await player.start("navigation", time_limit=60.0)
        self.rules = await player.read("rules")
        self.observed = await player.read("observe")
        (image,) = [
            one for one in (await player.ask("picture", marks=True)).content if isinstance(one, ImageContent)
        ]
        self.picture = base64.b64decode(image.data)
        self.early = text_of(await player.ask("record"))
        while "The match is over." not in self.end:
            self.end = await player.read("go", place="target", seconds=30.0, thought="There it is.")
        self.record = await player.read("record")
        address = self.record.splitlines()[1].removeprefix("resource: ")
        (content,) = (await player.client.read_resource(address)).contents
        self.blob = base64.b64decode(content.blob)


@pytest.fixture(scope="module")
def navigation(tmp_path_factory: pytest.TempPathFactory) -> Played:
    return Played(tmp_path_factory.mktemp("navigation"))


def test_a_client_is_told_what_it_needs_to_play(navigation: Played) -> None:
    assert navigation.begun.startswith("match: navigation-1\nseat: seat-")
    assert "Reach the target" in navigation.rules
    assert "Target: " in navigation.observed


def test_a_client_reaches_the_target_by_tools_alone(navigation: Played) -> None:
    assert "navigation-1: over, because of goal, after" in navigation.end
    assert 'seat 0 "client" (you): time ' in navigation.end
    assert "success 1" in navigation.end


def test_the_record_of_a_clients_match_is_verified(navigation: Played) -> None:
    path = Path(navigation.record.splitlines()[0])
    record = read_record(path)
    assert record.spec.clock == "paused"
    assert record.result.seats[0].metrics["success"] == 1.0
    assert verify_record(record).holds
    assert navigation.blob == path.read_bytes()
    assert "navigation-1 is not over" in navigation.early


def test_what_a_client_thinks_and_calls_is_shown_in_replays(navigation: Played) -> None:
    path = Path(navigation.record.splitlines()[0])
    notes = notes_beside(path, read_record(path))
    assert notes[0].text == "There it is. → go place target, seconds 30.0"
    assert (notes[0].seat, notes[0].public) == (0, False)
    assert notes[-1].text == "The match is over."


def test_the_picture_is_of_the_seats_camera(navigation: Played) -> None:
    image = Image.open(io.BytesIO(navigation.picture))
    assert (image.format, image.size) == ("PNG", (480, 270))
    assert len(navigation.picture) < 1 << 20


def test_two_clients_play_one_battle(tmp_path: Path) -> None:
    async def play(first: Player, second: Player) -> list[str]:
        begun = await first.start("battle", clients=2, others=["fighter-easy"], time_limit=3.0, name="Ada")
        assert '0 "Ada 1", 1 "Ada 2", 2 "fighter-easy"' in await second.join(begun)
        assert "no free seat" in text_of(await second.ask("join_match", code=begun.rsplit(" ", 1)[1]))
        waiting = asyncio.create_task(first.read("wait_until", seconds=1.0))
        await asyncio.sleep(0.2)
        assert not waiting.done(), "the world waits for the other client"
        ends = await asyncio.gather(waiting, second.read("wait_until", seconds=1.0))
        assert all(end.startswith("wait_until ended after 1.0 s: done") for end in ends)
        await asyncio.gather(*(one.read("wait_until", seconds=10.0) for one in (first, second)))
        return [await one.read("score") for one in (first, second)]

    scores = with_clients(tmp_path, 2, play)

    assert 'seat 0 "Ada 1" (you): ' in scores[0]
    assert 'seat 1 "Ada 2" (you): ' in scores[1]
    assert all("battle-1: over, because of time up, after 3.0 s" in score for score in scores)


def test_a_client_that_vanishes_costs_its_own_seat_alone(tmp_path: Path) -> None:
    async def play(first: Player, second: Player) -> tuple[str, str, str]:
        await second.join(await first.start("battle", clients=2, others=[], time_limit=2.0))
        ended = await first.read("wait_until", seconds=1.0)  # the other has said nothing
        gone = await second.read("observe") and await second.read("look_around")
        return ended, gone, await first.read("wait_until", seconds=5.0)

    ended, gone, last = with_clients(tmp_path, 2, play, Bounds(idle_limit=2.0))

    assert ended.startswith("wait_until ended after 1.0 s: done")
    assert gone.startswith("Your seat is closed: gave no answer for 2 s.")
    assert "The match is over." in last


def test_a_baseline_plays_with_a_client(tmp_path: Path) -> None:
    async def play(player: Player) -> str:
        await player.start("gathering", others=["homing", "gatherer-easy"], time_limit=1.0)
        await player.read("wait_until", seconds=10.0)
        return await player.read("record")

    path = Path(with_clients(tmp_path, 1, play).splitlines()[0])

    assert read_record(path).names == ("client", "homing", "gatherer-easy")


def test_whoever_leaves_stands_still_and_the_match_is_recorded(tmp_path: Path) -> None:
    async def play(player: Player) -> str:
        await player.start("navigation", time_limit=5.0)
        await player.read("leave")
        return await player.read("observe")

    said = with_clients(tmp_path, 1, play)

    assert said.startswith("Your seat is closed: its client left the match.")
    (record,) = tmp_path.glob("*/match.wsr")
    assert not read_record(record).actions.any()


@pytest.mark.parametrize(
    ("name", "arguments", "says"),
    [
        ("start_match", {"track": "racing"}, "track is 'racing'; the tracks are navigation, gathering"),
        ("start_match", {"level": "silly"}, "level: Input should be 'easy', 'normal'"),
        ("start_match", {"track": "battle", "senses": "pixels"}, "no seat of words can aim: play navigation"),
        ("start_match", {"speed": 3}, "start_match takes track, level, map, seed"),
        ("start_match", {"others": ["wizard"]}, "others has 'wizard'; the robots are walker-easy"),
        ("start_match", {"others": ["/etc"]}, "others has '/etc'"),
        ("start_match", {"others": ["random"] * 9}, "others has more than 8 baselines"),
        ("start_match", {"name": "x" * 21}, "name: String should match pattern"),
        ("start_match", {"name": "say\nthis"}, "name: String should match pattern"),
        ("join_match", {"code": "join-0"}, "no match has this join code"),
        ("observe", {"seat": "seat-0"}, "no seat has this handle"),
        ("observe", {}, "observe takes seat; seat: Field required"),
        ("go", {"seat": "seat-0", "bearing": 3}, "no seat has this handle"),
        ("go", {"bearing": 3}, "'go' needs the handle of your seat"),
        ("fly", {}, "'fly' needs the handle of your seat; the tools are start_match"),
    ],
)
def test_a_bad_call_is_answered_with_what_is_allowed(
    tmp_path: Path, name: str, arguments: dict[str, Any], says: str
) -> None:
    result = with_clients(tmp_path, 1, lambda player: player.ask(name, **arguments))

    assert result.is_error
    assert says in text_of(result)
    assert "\n" not in text_of(result)


def test_a_bad_call_of_a_tool_costs_game_time_and_is_counted(tmp_path: Path) -> None:
    async def play(player: Player) -> tuple[str, str]:
        await player.start("navigation")
        result = await player.ask("go", place="mars")
        assert result.is_error
        return text_of(result), await player.read("score")

    refused, score = with_clients(tmp_path, 1, play)

    assert refused.startswith("go ended after 0.5 s: refused. There is no such place")
    assert "Your calls: 1, refused: 1, steps played: 5." in score
    assert "You carry 0 supplies, your team 0." in score


def test_while_a_match_is_played_its_score_tells_nothing_of_others(tmp_path: Path) -> None:
    async def play(player: Player) -> str:
        await player.start("battle", others=["fighter-easy"])
        await player.read("wait_until", seconds=0.5)
        return await player.read("score")

    score = with_clients(tmp_path, 1, play)

    assert "fighter-easy" not in score
    assert "kills" not in score


def test_calls_after_the_end_write_no_notes_and_notes_are_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(matches, "MOST_NOTES", 200)

    async def play(player: Player) -> int:
        await player.start("navigation", time_limit=5.0)
        for _ in range(3):
            await player.read("wait_until", seconds=0.1, thought="I wait and see what comes of it.")
        size = logged()
        await player.read("leave")
        await player.read("wait_until", seconds=0.1)
        assert logged() == size
        return size

    def logged() -> int:
        (log,) = tmp_path.glob("*/match.seat-0.log")
        return log.stat().st_size

    assert 100 < with_clients(tmp_path, 1, play) <= 200


def test_a_match_that_is_being_made_takes_a_place_and_is_left_if_its_client_gives_up(tmp_path: Path) -> None:
    request = StartMatch.model_validate(SMALL)

    async def play() -> str:
        async with serving(tmp_path, Bounds(matches=1)) as matches:
            starting = asyncio.create_task(matches.start(request))
            await asyncio.sleep(0)
            starting.cancel()
            await asyncio.wait({starting})
            with pytest.raises(UserError, match="1 matches are being played"):
                await matches.start(request)
            while not [*matches]:  # noqa: ASYNC110 - nothing tells it
                await asyncio.sleep(0.01)
            (match,) = matches
            await match.task
            return match.hosted.seats[0].conduct.detail

    assert asyncio.run(play()) == "its client left the match"


@pytest.mark.parametrize("name", ["rules", "picture", "observe"])
def test_a_match_that_has_failed_before_it_began_says_so(tmp_path: Path, name: str) -> None:
    async def play() -> str:
        async with serving(tmp_path, Bounds()) as matches:
            match = await matches.start(StartMatch.model_validate(SMALL))
            match.hosted.cancel()
            await match.task
            ready = asyncio.get_running_loop().create_future()
            try:
                return (await Desk(matches, ready, None).answer(name, {"seat": match.seats[0].handle})).text
            except UserError as error:
                return str(error)

    assert asyncio.run(play()).startswith("the match was cancelled")


def test_one_call_of_a_seat_waits_at_a_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(desk, "TURN", 0.01)

    async def play(first: Player, second: Player) -> str:
        await second.join(await first.start("battle", clients=2, others=[], time_limit=1.0))
        waiting = asyncio.create_task(first.read("wait_until", seconds=1.0))
        await asyncio.sleep(0.1)
        refused = text_of(await first.ask("rules"))
        await second.read("leave")
        await waiting
        return refused

    assert with_clients(tmp_path, 2, play) == desk.BUSY


def test_only_so_many_matches_are_played_at_one_time(tmp_path: Path) -> None:
    async def play(player: Player) -> tuple[str, str]:
        await player.start("navigation")
        full = await player.client.call_tool("start_match", {"track": "navigation"} | SMALL)
        await player.read("leave")
        player.seat = ""
        return text_of(full), await player.start("navigation")

    full, again = with_clients(tmp_path, 1, play, Bounds(matches=1))

    assert full == "1 matches are being played: finish or leave one first"
    assert again.startswith("match: navigation-2")


def test_a_list_of_matches_opens_no_seat(tmp_path: Path) -> None:
    async def play(player: Player, other: Player) -> tuple[str, str]:
        begun = await player.start("navigation", clients=2)
        return begun, await other.read("list_matches")

    begun, listed = with_clients(tmp_path, 2, play)

    assert (
        listed == 'navigation-1: played for 0.0 s of game time; seats "client 1", "client 2"; 1 free for '
        "clients with the join code"
    )
    assert not [word for word in begun.split() if word.startswith(("seat-", "join-")) and word in listed]
