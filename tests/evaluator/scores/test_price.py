"""The price of thinking: what it is computed from, how it is drawn, and agents slowed down on purpose."""

import json
from pathlib import Path

import pytest
from tests.end_to_end.pages import json_documents
from tests.evaluator.results_by_hand import scored_results, timing_of_a_seat
from tests.evaluator.sample_agents import WALKER, Command, Submit
from tests.evaluator.small_matches import tiny_suite
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.cli.sessions.price import clocks_of, price_table, thinking_longer
from wildscav_evaluator.output.results import MatchTiming, Results
from wildscav_evaluator.scores.price import Price, draw_price, price_of
from wildscav_evaluator.submissions.submission import Submission


def played(clock: ClockChoice, scores: tuple[float, ...], thought: float) -> Results:
    """Results of a submission that made 4 decisions a match, for some seconds in all."""
    results = scored_results({("slow", "battle"): scores}, clock=clock)
    seats = (timing_of_a_seat(time_used=thought),)
    timings = [
        MatchTiming(submission="slow", track="battle", index=index, started=0, wall=1, steps=5, seats=seats)
        for index in range(len(scores))
    ]
    return results.model_copy(update={"timings": results.timings.model_copy(update={"matches": timings})})


@pytest.fixture(scope="module")
def price() -> Price:
    clocks = clocks_of("1, 4")
    scores = ((8.0, 9.0, 10.0), (5.0, 6.0, 7.0), (0.0, 1.0, 2.0))
    thoughts = (1.0, 1.0, 2.0)
    return price_of([played(*one) for one in zip(clocks, scores, thoughts, strict=True)])


def test_the_delay_is_the_game_time_that_passes_during_a_decision(price: Price) -> None:
    assert [point.thinking for point in price.points] == [0.25, 0.25, 0.5]
    assert [point.delay for point in price.points] == [0.0, 0.25, 2.0]
    assert [point.score.mean for point in price.points] == [9.0, 6.0, 1.0]
    assert price.title == "slow 1.0.0 · battle · suite quick · seed 0 · 3 matches a point"
    assert [next(iter(column.cells)) for column in price_table(price).columns][:3] == [
        "paused",
        "0.250",
        "0.000",
    ]


def test_the_picture_is_a_png_and_equal_prices_give_equal_ones(price: Price, tmp_path: Path) -> None:
    first, second = (draw_price(price, tmp_path / name).read_bytes() for name in ("a.png", "b.png"))
    assert first == second
    assert first.startswith(b"\x89PNG")


def test_equal_scores_are_drawn_although_their_interval_is_rounded(tmp_path: Path) -> None:
    equal = price_of([played(ClockChoice(clock="paused"), (0.1, 0.1, 0.1, 0.1, 0.1, 0.1), 1.0)], think=0.2)
    (point,) = equal.points
    assert point.score.mean < point.score.low or point.score.high < point.score.mean

    assert draw_price(equal, tmp_path / "equal.png").exists()
    assert (equal.think, equal.title.partition(" · suite")[0]) == (0.2, "slow 1.0.0 · 0.2 s slower · battle")


@pytest.mark.parametrize(
    ("paces", "fault"),
    [
        ("1,1.0", "twice"),
        ("0", "equal to 0.001"),
        ("1,,2", "valid number"),
        ("x", "^--paces x: "),
    ],
)
def test_paces_are_different_numbers(paces: str, fault: str) -> None:
    with pytest.raises(UserError, match=fault):
        clocks_of(paces)


@pytest.mark.parametrize(("more", "method"), [("", "act"), ('\ninterface = "words"\n', "play")])
def test_an_agent_is_slowed_down_in_a_copy(submit: Submit, more: str, method: str) -> None:
    walker = submit("walker", WALKER, more=more)
    with thinking_longer(walker, 0.25) as slow:
        assert (slow.name, slow.manifest.entry_point) == ("walker", "slowed_down:Slowed")
        code = (slow.folder / "slowed_down.py").read_text()
        assert f"    def {method}(self, " in code
        assert "time.sleep(0.25)" in code
        compile(code, "slowed_down.py", "exec")
        assert walker.manifest.entry_point == "agent:Player"
        copy = slow.folder
    assert not copy.exists()
    with thinking_longer(walker, 0.0) as same:
        assert same is walker


def test_an_agent_that_is_no_python_is_not_slowed_down(submit: Submit) -> None:
    walker = submit("walker", WALKER)
    image = Submission(walker.folder, walker.manifest, walker.digest, image="walker:1")
    with pytest.raises(UserError, match="slows down agents in Python alone"), thinking_longer(image, 1.0):
        pass


@pytest.mark.slow
def test_the_command_plays_paused_and_at_each_pace(
    wildscav: Command, submit: Submit, warm_workers: WarmWorkers, tmp_path: Path
) -> None:
    suite = tiny_suite(tmp_path, maps=1, seconds=2)
    agent, out = submit("walker", WALKER).folder, tmp_path / "out"
    with playing_with(warm_workers):
        done = wildscav(
            *("price", agent, "--suite", suite, "--sandbox", "process", "--rounds", "1"),
            *("--paces", "4", "--think", "0.1", "--workers", "1", "--out", out, "--json"),
        )
    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    paused, fast = document["points"]
    left_out = {"interface", "model"}  # of agents of numbers, and of those that ask no model
    assert document.keys() | paused.keys() | left_out == json_documents()["price"]
    assert paused["thinking"] >= 0.1
    assert fast["delay"] >= 0.4
    assert {path.name for path in out.iterdir()} == {"paused", "pace-4", "price.json", "price.png"}
    verified = wildscav("verify", out / "pace-4", "--json")
    assert verified.returncode == 0
    assert json.loads(verified.stdout).keys() == json_documents()["verify of a folder"]
