"""How well a scripted reader plays by the texts of a seat of words alone, and what these texts cost.

    python -m benchmarks.strength.words --track gathering --senses sighted --matches 40

plays the same matches of a level with ``benchmarks/strength/reader`` and with ``homing``, and compares them.
"""

import statistics
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Annotated, Any, Literal

import typer
from rich.progress import track as progress

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav_engine.sensors import parse_sensors
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import Senses
from wildscav_language.seat import Counts, Seat
from wildscav_language.senses import sensors
from wildscav_server.hosting.manifest import Manifest
from wildscav_training.opponents import SubmissionOpponent, named_agent
from wildscav_training.trials import SUCCESS, Trial, half_width, matches_on, mean, play, rate

READER = Path(__file__).parent / "reader"
SCORES = {"navigation": SUCCESS, "gathering": "supplies"}


class Readers(SubmissionOpponent):
    """The reader in this process, with what its last match came to."""

    def _load(self, manifest: Manifest) -> Callable[[], Agent]:
        self._sensors = parse_sensors(sensors())
        return partial(InThread, self._class_in(manifest))

    @property
    def counts(self) -> Counts:
        """Calls, texts and bytes of its last match."""
        seat: Seat = self._agents[0, 0].seat  # type: ignore[attr-defined]
        seat.finish()
        return seat.counts


class InThread(Agent):
    """Plays as a player of words does, who runs in a thread of its own.

    Args:
        make: Makes the player.
    """

    def __init__(self, make: Callable[[], Any]) -> None:
        self.seat = Seat()
        self._playing = Thread(target=make().play, args=(self.seat,), daemon=True)

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.seat.begin(match)
        self._playing.start()

    def act(self, observation: Observation) -> Action:
        """Return the next action of the running tool."""
        return self.seat.answer(observation)


def ratio(own: Sequence[float], others: Sequence[float]) -> tuple[float, float]:
    """Return the ratio of two means of the same matches, and the half width of its 95 % interval.

    The interval is that of the delta method (Cochran, "Sampling Techniques", 1977, section 6.3).
    """
    below = statistics.fmean(others)
    middle = statistics.fmean(own) / below
    rest = [one - middle * other for one, other in zip(own, others, strict=True)]
    return middle, half_width(rest) / below


def said_of_scores(name: str, trials: Sequence[Trial], track: str) -> str:
    """Return a line about an agent's scores."""
    scores = [trial.metrics[SCORES[track]] for trial in trials]
    shown = rate(scores) if track == "navigation" else mean(scores, digits=0)
    spl = f", SPL {mean([trial.metrics['spl'] for trial in trials])}" if track == "navigation" else ""
    return f"{name}: {SCORES[track]} {shown}{spl}\n"


def said_of_counts(counts: Sequence[Counts]) -> str:
    """Return what the matches of the reader cost."""
    texts, size = sum(one.texts for one in counts), sum(one.bytes for one in counts)
    return (
        f"{statistics.fmean(one.decisions for one in counts):.0f} decisions a match, of "
        f"{sum(one.steps for one in counts) / sum(one.calls for one in counts):.0f} steps each; "
        f"{sum(one.refused for one in counts)} calls refused; {size / texts:.0f} bytes a text, "
        f"{max(one.longest for one in counts)} at most\n"
    )


def main(
    track: Annotated[Literal["navigation", "gathering"], typer.Option(help="The track.")] = "navigation",
    senses: Annotated[Literal["original", "sighted"], typer.Option(help="What is told.")] = "original",
    matches: Annotated[int, typer.Option(help="Matches of the level easy.", min=2)] = 40,
    first: Annotated[int, typer.Option(help="The first of them.", min=0)] = 0,
) -> None:
    """Play, and print what both reach."""
    reader, homing = Readers(READER), named_agent("homing")
    played: dict[str, list[Trial]] = {"reader": [], "homing": []}
    counts: list[Counts] = []
    specs: list[MatchSpec] = list(matches_on(track, "easy", first + matches))[first:]
    for spec in progress(specs, track):
        rules = spec.rules._replace(senses=int(Senses[senses.upper()]))
        changed = spec.model_copy(update={"rules": rules})
        played["reader"].append(play(reader, changed))
        counts.append(reader.counts)
        played["homing"].append(play(homing, changed))
    sys.stdout.write(f"{track}, easy, {senses}, {len(specs)} matches\n")
    for name, trials in played.items():
        sys.stdout.write(said_of_scores(name, trials, track))
    if track == "gathering":
        both = [[trial.metrics["supplies"] for trial in trials] for trials in played.values()]
        middle, reach = ratio(*both)
        sys.stdout.write(f"reader / homing: {middle:.2f} ± {reach:.2f}\n")
    sys.stdout.write(said_of_counts(counts))


if __name__ == "__main__":
    typer.run(main)
