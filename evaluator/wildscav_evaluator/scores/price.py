"""The price of thinking: the score of an agent over the game time that passes while it thinks."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.output.json_files import FileModel, WithOptionalFields
from wildscav_evaluator.output.results import (
    KeptLimits,
    MetricInfo,
    ModelTerms,
    OtherInterface,
    Results,
    Summary,
    Versions,
    with_interface,
)
from wildscav_evaluator.scores.number_format import unit_and_title

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PRICE_FILE, PRICE_PICTURE = "price.json", "price.png"
DOTS_PER_INCH = 110
LINE, BAND, GRID = "#0072b2", "#cfe3f1", "#d8dee4"


class Point(FileModel):
    """How an agent played the matches by one clock."""

    clock: ClockChoice
    thinking: float  # s, the mean of its decisions
    delay: float  # s of game time that passed meanwhile
    score: Summary
    matches: int
    faults: int  # matches in which something went wrong


class Price(WithOptionalFields):
    """The price of thinking of one agent on one track."""

    omitted = ("interface", "model")

    format: Literal[1] = 1
    versions: Versions
    submission: str
    version: str
    digest: str
    interface: OtherInterface | None = None  # by which it plays; omitted for numbers
    think: float = 0.0  # s by which every decision was slowed down on purpose
    track: str
    suite: str
    seed: str  # or the beginning of the commitment, if it is hidden
    rounds: int
    sandbox: str
    limits: dict[str, KeptLimits]
    model: ModelTerms | None = None  # that it could ask; omitted if there was none
    metric: MetricInfo
    points: tuple[Point, ...]  # the first is of matches that wait for all answers

    @property
    def title(self) -> str:
        """A short description of what was played."""
        name = with_interface(f"{self.submission} {self.version}", self.interface)
        slowed = f" · {self.think:g} s slower" if self.think else ""
        return (
            f"{name}{slowed} · {self.track} · suite {self.suite} · seed {self.seed} · "
            f"{self.points[0].matches} matches a point"
        )


def label_of(clock: ClockChoice) -> str:
    """Return the name of a point: its clock, by ``running`` its pace."""
    return f"pace {clock.thinking.pace:g}" if clock.clock == "running" else clock.clock


def price_of(played: Sequence[Results], think: float = 0.0) -> Price:
    """Return the price that follows from evaluations of one submission on one track, by several clocks.

    ``think`` is by how many seconds every decision was slowed down. ValueError if by one clock no match was
    played.
    """
    first, evaluation = played[0], played[0].evaluations[0]
    return Price.about(
        first,
        format=1,
        submission=evaluation.submission,
        version=evaluation.version,
        digest=evaluation.digest,
        interface=evaluation.interface,
        think=think,
        track=evaluation.track,
        seed=first.seed_label,
        metric=evaluation.metrics[0],
        points=tuple(map(_point, played)),
    )


def _point(results: Results) -> Point:
    (evaluation,), clock = results.evaluations, results.clock or ClockChoice()
    if evaluation.score is None:
        raise ValueError(f"no match was played by the clock {clock}: {evaluation.matches[0].detail}")
    seats = [seat for match in results.timings.matches for seat in match.seats]
    decisions = sum(seat.steps - seat.late_steps for seat in seats)
    thinking = sum(seat.time_used for seat in seats) / max(1, decisions)
    return Point(
        clock=clock,
        thinking=thinking,
        delay=thinking * clock.thinking.pace if clock.clock == "running" else 0.0,
        score=evaluation.score,
        matches=len(evaluation.matches),
        faults=evaluation.faults,
    )


def draw_price(price: Price, path: Path) -> Path:
    """Draw a price as a PNG, whole or not at all, and return its path."""
    from wildscav_evaluator.ratings.picture import draw_figure

    return draw_figure(lambda: _figure(price), path)


def _figure(price: Price) -> "Figure":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 4.2), dpi=DOTS_PER_INCH, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    points = sorted(price.points, key=lambda point: point.delay)
    delays, means = [point.delay for point in points], [point.score.mean for point in points]
    spans = [  # of equal scores, rounding puts a bound on the wrong side of the mean
        [max(0.0, one.score.mean - one.score.low) for one in points],
        [max(0.0, one.score.high - one.score.mean) for one in points],
    ]
    axes.errorbar(delays, means, spans, color=LINE, marker="o", markersize=5.0, ecolor=BAND, elinewidth=4.0)
    for point in points:
        place = (point.delay, point.score.mean)
        axes.annotate(
            label_of(point.clock), place, (4.0, 4.0), textcoords="offset points", fontsize=8, rotation=40
        )
    axes.set_title(price.title, fontsize=10, loc="left")
    axes.set_xlabel("delay: game time that passes during a decision [s]")
    axes.set_ylabel(f"{unit_and_title(price.metric)}, mean and 95 % interval")
    axes.grid(color=GRID)
    axes.spines[["top", "right"]].set_visible(False)
    axes.margins(x=0.08)
    return figure
