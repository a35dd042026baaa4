"""How agents play the suite ``reading``, by scores of which ``random`` has 0 and a reference agent 1.

    python -m benchmarks.strength.reading --rounds 4 --out benchmarks/results/reading.json
    python -m benchmarks.strength.reading --show benchmarks/results/reading.json

plays the same matches with each agent in this process. The scores that the suite calls 0 and 1 are the means
in that file, which also says how often the reader of ``benchmarks/strength/reader`` decided in each match.
"""

import json
import statistics
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any

import typer
from benchmarks.strength.words import READER, Readers

from wildscav.errors import UserError
from wildscav_evaluator.output.results import Estimate, metric_infos
from wildscav_evaluator.scores.overall import across_tracks
from wildscav_evaluator.suites.reading import READING
from wildscav_training.opponents import named_agent
from wildscav_training.trials import play

FIRST = 1000  # the seed of the first round
# The best one known by the rules of the suite on each track is the reference.
AGENTS = {
    "navigation": ("random", "homing", "hunter", "navigator", "mapper", "reader"),
    "gathering": ("random", "homing", "hunter", "scavenger", "reader"),
    "capture": ("random", "homing", "hunter", "reader"),
    "battle": ("random", "homing", "hunter", "commando", "scavenger", "reader"),
    "royale": ("random", "homing", "hunter", "commando", "scavenger", "survivor", "reader"),
}
Scores = dict[str, dict[str, list[float]]]  # of each match, by agent and track


def play_all(tracks: Iterator[str] | tuple[str, ...], rounds: int) -> dict[str, Any]:
    """Play rounds of the suite, and return the scores and the decisions of the reader, by track."""
    scores: Scores = {}
    decisions: dict[str, list[int]] = {}
    for track in tracks:
        agents = {name: Readers(READER) if name == "reader" else named_agent(name) for name in AGENTS[track]}
        score = metric_infos(track)[0].name
        for spec in (spec for number in range(rounds) for spec in READING.matches(track, FIRST + number)):
            for name, agent in agents.items():
                reached = round(play(agent, spec).metrics[score], 3)
                scores.setdefault(name, {}).setdefault(track, []).append(reached)
                if isinstance(agent, Readers):
                    decisions.setdefault(track, []).append(agent.counts.decisions)
    return {"first": FIRST, "rounds": rounds, "scores": scores, "decisions": decisions}


def rows(played: Mapping[str, Any]) -> Iterator[str]:
    """Yield the table: normalized scores on each track, and overall where an agent played all of them."""
    yield f"| agent | {' | '.join(AGENTS)} | mean | IQM |"
    yield "|---" * (len(AGENTS) + 3) + "|"
    for name, by_track in played["scores"].items():
        normalized = {
            track: [READING.references[track].normalized(score) for score in by_track.get(track, ())]
            for track in AGENTS
        }
        cells = [f"{statistics.fmean(scores):.2f}" if scores else "" for scores in normalized.values()]
        overall = across_tracks(list(normalized.values())) if all(normalized.values()) else ()
        shown = [in_words(one) for one in overall] or ["", ""]
        yield f"| `{name}` | {' | '.join([*cells, *shown])} |"


def in_words(one: Estimate) -> str:
    """Return an estimate with its interval."""
    return f"{one.value:.2f} ({one.low:.2f} to {one.high:.2f})"


def said_of(played: Mapping[str, Any]) -> Iterator[str]:
    """Yield the mean scores, and how often the reader decided."""
    for name, by_track in played["scores"].items():
        yield f"{name}: " + ", ".join(
            f"{track} {statistics.fmean(each):.3f}" for track, each in by_track.items()
        )
    for track, counts in played["decisions"].items():
        yield f"{track}: {statistics.median(counts):g} decisions of the reader, {max(counts)} at most"


def main(
    rounds: Annotated[int, typer.Option(help="Rounds of six matches on each track.", min=1)] = 1,
    track: Annotated[list[str] | None, typer.Option(help="Only this track; may be repeated.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="Write the scores there, over those of these tracks.")
    ] = None,
    show: Annotated[Path | None, typer.Option(help="Play nothing, and show this file.")] = None,
) -> None:
    """Play, and print what the agents reach."""
    for name in track or ():
        if name not in AGENTS:
            raise UserError(f"--track is {name!r}; the tracks are {', '.join(AGENTS)}", exit_code=2)
    played = json.loads(show.read_text()) if show else play_all(tuple(track or AGENTS), rounds)
    if out is not None:
        out.write_text(json.dumps(played) + "\n")
    sys.stdout.write("\n".join([*said_of(played), "", *(rows(played) if READING.references else ())]) + "\n")


if __name__ == "__main__":
    typer.run(main)
