"""Where an evaluation stands: counts, scores so far and the time left."""

from dataclasses import replace

import pytest
from rich.console import Console
from tests.evaluator.monitoring.jobs_by_hand import jobs, played

from wildscav_evaluator.matches.jobs import Heartbeat
from wildscav_evaluator.monitoring.dashboard import dashboard, duration
from wildscav_evaluator.monitoring.tally import Tally


class Clock:
    """A clock that goes when it is told to."""

    now = 1000.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_every_match_is_waiting_then_running_then_done(clock: Clock) -> None:
    first, second, third = every = jobs(navigation=3)
    tally = Tally(every, clock=clock)
    assert (tally.waiting, len(tally.running), len(tally.done)) == (3, 0, 0)

    tally.start(first)
    tally.start(second)
    tally.add(played(first, 5.0))
    (line,) = tally.add(played(second, 5.0, fault=True))

    assert (tally.waiting, len(tally.running), len(tally.done), tally.failed) == (1, 0, 2, 1)
    assert (line.done, line.running, line.failed, line.complete) == (2, 0, 1, False)
    assert tally.add(played(third, 5.0))[0].complete


def test_a_match_that_is_only_rendered_now_is_not_counted_again(clock: Clock) -> None:
    (job,) = jobs(navigation=1)
    tally = Tally([job], clock=clock)
    tally.add(played(job, 5.0))

    tally.start(job)
    (line,) = tally.add(played(job, 5.0))

    assert (line.done, line.running, len(line.scores), tally.waiting) == (1, 0, 1, 0)


def test_scores_so_far_have_their_interval(clock: Clock) -> None:
    every = jobs(navigation=4)
    tally = Tally(every, clock=clock)
    for job, score in zip(every, (2.0, 4.0, 6.0), strict=False):
        (line,) = tally.add(played(job, 1.0, score))

    assert line.summary is not None
    assert (line.summary.mean, line.summary.low, line.summary.high) == (4.0, 2.0, 6.0)


def test_the_time_left_is_that_of_what_is_left_shared_by_those_who_play(clock: Clock) -> None:
    every = jobs(navigation=5)
    tally = Tally(every, at_once=2, clock=clock)
    assert tally.time_left() is None

    tally.add(played(every[0], 10.0))
    tally.start(every[1])
    clock.now += 4.0

    # 6 s of the match that runs, and three times 10 s, by two.
    assert tally.time_left() == pytest.approx(18.0)


def test_a_track_that_nobody_has_played_yet_is_reckoned_by_its_length(clock: Clock) -> None:
    every = jobs(navigation=1, battle=1)
    tally = Tally(every, clock=clock)

    tally.add(played(every[0], 10.0))

    assert tally.time_left() == pytest.approx(10.0)  # both last 60 s for one agent


def test_robots_are_reckoned_as_a_tenth_of_an_agent(clock: Clock) -> None:
    (first,) = jobs(navigation=1)
    (battle,) = jobs(battle=1)
    seats = ("submission", *("fighter",) * 9)
    crowded = replace(battle, spec=battle.spec.model_copy(update={"seats": seats}))
    tally = Tally([first, crowded], clock=clock)

    tally.add(played(first, 10.0))

    assert tally.time_left() == pytest.approx(19.0)


def test_the_speed_is_that_of_the_matches_that_run(clock: Clock) -> None:
    first, second = every = jobs(navigation=2)
    tally = Tally(every, at_once=2, clock=clock)
    for job in every:
        tally.start(job)
        tally.beat(job, Heartbeat(0, 0))

    clock.now += 2.0
    tally.beat(first, Heartbeat(500, 100))
    tally.beat(second, Heartbeat(1000, 200))
    assert tally.speed == pytest.approx(150.0)

    tally.add(played(first, 2.0))
    assert tally.speed == pytest.approx(100.0)


HEADS = ("navigation s used + punish time ↓", "gathering supplies ↑")


def shown(tally: Tally, width: int = 80) -> list[str]:
    console = Console(width=width, force_terminal=True, color_system=None, legacy_windows=False)
    with console.capture() as captured:
        console.print(dashboard(tally, "suite quick · seed 0", width))
    return [" ".join(line.split()) for line in captured.get().splitlines()]


def test_the_dashboard_shows_it_all(clock: Clock) -> None:
    every = jobs(navigation=3, gathering=2)
    tally = Tally(every, at_once=2, clock=clock)
    tally.add(played(every[0], 30.0, 2.0))
    tally.add(played(every[1], 30.0, 6.0, fault=True))
    tally.start(every[2])
    tally.beat(every[2], Heartbeat(0, 0))
    clock.now += 65.0
    tally.beat(every[2], Heartbeat(1000, 130))
    tally.start(every[3])

    lines = shown(tally)

    assert lines[0] == "suite quick · seed 0"
    assert lines[2] == "1 min 05 s elapsed, about 30 s left"
    assert lines[1].endswith("2 of 5 matches done, 2 running, 1 waiting, 1 failed")
    navigation, gathering = (lines.index(head) for head in HEADS)
    assert lines[navigation + 1].startswith("walker ")
    assert lines[navigation + 1].endswith(" 2/3 4.0 2.0–6.0 1 failed")
    assert lines[gathering + 1].endswith(" 0/2 - running")
    assert any("navigation-002-walker" in line and line.endswith("20 of 60 s") for line in lines)
    assert "playing 2 steps/s" in lines
    assert any("gathering-000-walker" in line and "starting" in line for line in lines)


@pytest.mark.parametrize("width", [40, 60, 77])
def test_a_narrow_terminal_shows_every_figure_whole(clock: Clock, width: int) -> None:
    every = jobs(navigation=110)
    for index, job in enumerate(every):
        every[index] = replace(job, evaluated="an-agent-with-a-long-name")
    tally = Tally(every, clock=clock)
    for job in every[:100]:
        tally.add(played(job, 30.0, 123.4, fault=job is every[7]))
    tally.start(every[100])
    tally.beat(every[100], Heartbeat(1000, 130))

    lines = shown(tally, width)

    assert lines[lines.index(HEADS[0]) + 1].endswith(" 100/110 123.4 1 failed")
    assert lines[-1].startswith("navigation-100-an-") or lines[-2].startswith("navigation-100-an-")
    assert any(line.endswith("20 of 60 s") for line in lines)


def test_many_running_matches_do_not_fill_the_terminal(clock: Clock) -> None:
    every = jobs(navigation=40)
    tally = Tally(every, at_once=40, clock=clock)
    for job in every:
        tally.start(job)

    lines = shown(tally)

    assert len(lines) < 20
    assert "and 32 more" in lines


@pytest.mark.parametrize(
    ("seconds", "says"), [(0.4, "0 s"), (59.0, "59 s"), (65.0, "1 min 05 s"), (3725.0, "1 h 02 min")]
)
def test_durations(seconds: float, says: str) -> None:
    assert duration(seconds) == says
