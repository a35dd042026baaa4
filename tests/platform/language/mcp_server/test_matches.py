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
from tests.platform.language.mcp_server.clients import SMALL, Player, at_server, clients, text_of

from wildscav.errors import UserError
from wildscav_engine.record import read_record, verify_record
from wildscav_language.mcp_server import desk, matches, reports
from wildscav_language.mcp_server.desk import Desk
from wildscav_language.mcp_server.matches import Bounds, serving
from wildscav_language.mcp_server.requests import StartMatch
from wildscav_stage.scene.notes import notes_beside


class Played:
    """A navigation that one client has played from tools alone."""

    def __init__(self, folder: Path) -> None:
        self.begun = self.observed = self.rules = self.early = self.end = self.record = ""
        self.blob, self.picture = b"", b""
        asyncio.run(self._play(folder))

    async def _play(self, folder: Path) -> None:
        async with clients(folder) as (player, *_):
            await self._ask(player)

    async def _ask(self, player: Player) -> None:
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


@at_server()
async def test_two_clients_play_one_battle(first: Player, second: Player) -> None:
    begun = await first.start("battle", clients=2, others=["fighter-easy"], time_limit=3.0, name="Ada")
    assert '0 "Ada 1", 1 "Ada 2", 2 "fighter-easy"' in await second.join(begun)
    assert "no free seat" in text_of(await second.ask("join_match", code=begun.rsplit(" ", 1)[1]))
    waiting = asyncio.create_task(first.read("wait_until", seconds=1.0))
    await asyncio.sleep(0.2)
    assert not waiting.done(), "the world waits for the other client"
    ends = await asyncio.gather(waiting, second.read("wait_until", seconds=1.0))
    assert all(end.startswith("wait_until ended after 1.0 s: done") for end in ends)
    await asyncio.gather(*(one.read("wait_until", seconds=10.0) for one in (first, second)))
    scores = [await one.read("score") for one in (first, second)]

    assert 'seat 0 "Ada 1" (you): ' in scores[0]
    assert 'seat 1 "Ada 2" (you): ' in scores[1]
    assert all("battle-1: over, because of time up, after 3.0 s" in score for score in scores)


@at_server(Bounds(idle_limit=2.0))
async def test_a_client_that_vanishes_costs_its_own_seat_alone(first: Player, second: Player) -> None:
    await second.join(await first.start("battle", clients=2, others=[], time_limit=2.0))
    ended = await first.read("wait_until", seconds=1.0)  # the other has said nothing
    gone = await second.read("observe") and await second.read("look_around")
    last = await first.read("wait_until", seconds=5.0)

    assert ended.startswith("wait_until ended after 1.0 s: done")
    assert gone.startswith("Your seat is closed: gave no answer for 2 s.")
    assert "The match is over." in last


@at_server()
async def test_a_baseline_plays_with_a_client(player: Player) -> None:
    await player.start("gathering", others=["homing", "gatherer-easy"], time_limit=1.0)
    await player.read("wait_until", seconds=10.0)
    path = Path((await player.read("record")).splitlines()[0])

    assert read_record(path).names == ("client", "homing", "gatherer-easy")


@at_server()
async def test_whoever_leaves_stands_still_and_the_match_is_recorded(player: Player, tmp_path: Path) -> None:
    await player.start("navigation", time_limit=5.0)
    await player.read("leave")
    said = await player.read("observe")

    assert said.startswith("Your seat is closed: its client left the match.")
    (record,) = tmp_path.glob("*/match.wsr")  # noqa: ASYNC240
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
@at_server()
async def test_a_bad_call_is_answered_with_what_is_allowed(
    player: Player, name: str, arguments: dict[str, Any], says: str
) -> None:
    result = await player.ask(name, **arguments)

    assert result.is_error
    assert says in text_of(result)
    assert "\n" not in text_of(result)


@at_server()
async def test_a_bad_call_of_a_tool_costs_game_time_and_is_counted(player: Player) -> None:
    await player.start("navigation")
    result = await player.ask("go", place="mars")
    assert result.is_error
    refused, score = text_of(result), await player.read("score")

    assert refused.startswith("go ended after 0.5 s: refused. There is no such place")
    assert "Your calls: 1, refused: 1, steps played: 5." in score
    assert "You carry 0 supplies, your team 0." in score


@at_server()
async def test_while_a_match_is_played_its_score_tells_nothing_of_others(player: Player) -> None:
    await player.start("battle", others=["fighter-easy"])
    await player.read("wait_until", seconds=0.5)
    score = await player.read("score")

    assert "fighter-easy" not in score
    assert "kills" not in score


@at_server()
async def test_calls_after_the_end_write_no_notes_and_notes_are_bounded(
    player: Player, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(matches, "MOST_NOTES", 200)

    def logged() -> int:
        (log,) = tmp_path.glob("*/match.seat-0.log")
        return log.stat().st_size

    await player.start("navigation", time_limit=5.0)
    for _ in range(3):
        await player.read("wait_until", seconds=0.1, thought="I wait and see what comes of it.")
    size = logged()
    await player.read("leave")
    await player.read("wait_until", seconds=0.1)
    assert logged() == size

    assert 100 < size <= 200


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


def test_a_closed_seat_is_not_free_and_a_removed_folder_costs_no_call(tmp_path: Path) -> None:
    async def play() -> str:
        async with serving(tmp_path, Bounds()) as matches:
            match = await matches.start(StartMatch.model_validate(SMALL | {"clients": 2}))
            match.hosted.give_up(1, "nobody came")
            match.next_seat()
            match.folder.rmdir()
            match.note(match.seats[0], "I go.")
            return reports.state(match)

    assert "free" not in asyncio.run(play())


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


@at_server()
async def test_one_call_of_a_seat_waits_at_a_time(
    first: Player, second: Player, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(desk, "TURN", 0.01)
    await second.join(await first.start("battle", clients=2, others=[], time_limit=1.0))
    waiting = asyncio.create_task(first.read("wait_until", seconds=1.0))
    await asyncio.sleep(0.1)
    assert text_of(await first.ask("rules")) == desk.BUSY
    await second.read("leave")
    await waiting


@at_server(Bounds(matches=1))
async def test_only_so_many_matches_are_played_at_one_time(player: Player) -> None:
    await player.start("navigation")
    full = await player.client.call_tool("start_match", {"track": "navigation"} | SMALL)
    await player.read("leave")
    player.seat = ""
    full, again = text_of(full), await player.start("navigation")

    assert full == "1 matches are being played: finish or leave one first"
    assert again.startswith("match: navigation-2")


@at_server()
async def test_a_list_of_matches_opens_no_seat(first: Player, second: Player) -> None:
    begun = await first.start("navigation", clients=2)
    listed = await second.read("list_matches")

    assert (
        listed == 'navigation-1: played for 0.0 s of game time; seats "client 1", "client 2"; 1 free for '
        "clients with the join code"
    )
    assert not [word for word in begun.split() if word.startswith(("seat-", "join-")) and word in listed]
