"""What the harness of language models adds to a model's answer, and what whole matches ask of a model.

    python -m benchmarks.services.harness
    python -m benchmarks.services.harness --matches 2

The model is a script on this machine, which answers at once. Tokens are a quarter of the characters.
"""

import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import httpx2
import typer
from benchmarks.report import Figure, JsonFile, publish
from tests.platform.wildscav.harness.model_matches import model_match
from tests.platform.wildscav.harness.played_seats import PlayedSeat, Reply
from tests.scripted_mind import mind
from tests.scripted_model import ScriptedModel, called, in_turn

from wildscav.harness.player import ModelPlayer
from wildscav.harness.settings import ModelSettings
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.suites.suite import suite

ANSWERS, ROUNDS = 40, 5
NAMES = ("a bare client", "the harness at a URL", "the harness at a gateway's socket")
TEXT = "\n".join(["- box 12: 3 o'clock, bearing 189°, 6.1 m, 3.2 m higher, 25 supplies"] * 35)  # 2,500 bytes


class LongSeat(PlayedSeat):
    """A seat whose texts are as long as those of a gathering."""

    def call(self, name: str, arguments: Any) -> Reply:
        """Play nothing."""
        return Reply(f"{super().call(name, arguments).text}\n{TEXT}")


def latency(folder: Path) -> list[Figure]:
    """Measure answers that a model gives at once: to a bare client, and through the harness."""
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in NAMES}
    script = in_turn(called("go", place="target"))
    socket = ScriptedModel(script, path=folder / "model.sock")
    with ScriptedModel(script) as model, socket, httpx2.Client() as client:
        for _ in range(ROUNDS):
            for name, url in zip(NAMES[1:], (model.url, socket.url), strict=True):
                player = ModelPlayer(LongSeat(ANSWERS), ModelSettings(url=url))
                times[name].append(_each(player.play))
            post = partial(client.post, f"{model.url}/chat/completions", json=model.requests[-1].body)
            times[NAMES[0]].append(_each(partial(_repeat, post)))
    return [
        Figure(
            f"{name}, processor time",
            min(processor for _, processor in found),
            "ms",
            f"median to the answer {statistics.median(wall for wall, _ in found):.1f} ms",
        )
        for name, found in times.items()
    ]


def _repeat(work: Callable[[], object]) -> None:
    for _ in range(ANSWERS):
        work()


def _each(work: Callable[[], object]) -> tuple[float, float]:
    """Return the wall and the thread's processor time for each answer, ms."""
    began, used = time.perf_counter(), time.thread_time()
    work()
    scale = 1e3 / ANSWERS
    return (time.perf_counter() - began) * scale, (time.thread_time() - used) * scale


def matches(count: int) -> list[Figure]:
    """Measure what whole matches of the quick suite ask of a model."""
    figures = []
    for track in TRACKS:
        spent = []
        for spec in list(suite(track, "quick", 0))[:count]:
            paused = spec.model_copy(update={"clock": "paused"})
            with tempfile.TemporaryDirectory() as folder:
                spent.append(model_match(paused, mind, Path(folder)).course.spending)
        mean = {name: statistics.fmean(getattr(one, name) for one in spent) for name in spent[0].__slots__}
        note = f"{mean['requests']:.0f} answers, {mean['answer_tokens']:,.0f} tokens of them"
        figures.append(Figure(f"{track}: tokens of prompts", mean["prompt_tokens"], "", note))
    return figures


def main(
    count: Annotated[int, typer.Option("--matches", help="Matches of each track.", min=0)] = 1,
    json_file: JsonFile = None,
) -> None:
    """Measure the harness."""
    with tempfile.TemporaryDirectory() as folder:
        figures = latency(Path(folder)) + (matches(count) if count else [])
    publish("a scripted model through the harness", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
