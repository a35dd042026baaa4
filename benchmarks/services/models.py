"""How many paused matches at once a machine plays while their agents wait for a language model.

    python -m benchmarks.services.models 2 8 16

The model is a script on this machine. Each worker plays two matches in bubblewrap.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import typer
from benchmarks.report import Figure, JsonFile, publish, time_of_children
from tests.scripted_mind import mind
from tests.scripted_model import Late, ScriptedModel

TALKER = Path(__file__).parents[2] / "submissions" / "talker"
ANSWER = 2.0  # s after which the model answers
SUITE = """
name = "waiting"
map = {{ size = 60, houses = 1 }}
[tracks.gathering]
maps = {matches}
episodes = 1
match = {{ time_limit = 60, clock = "paused" }}
"""


def memory(process: int) -> float:
    """Return the memory of a process and its descendants, MB; a page that n share counts 1/n for each."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
        lists = [path.read_text() for path in Path(f"/proc/{process}/task").glob("*/children")]
    except OSError:  # it has ended
        return 0.0
    own = sum(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1e3
    return own + sum(memory(int(child)) for children in lists for child in children.split())


def measure(workers: int, model: ScriptedModel, folder: Path) -> list[Figure]:
    """Play matches with so many workers."""
    matches, asked, most = 2 * workers, len(model.requests), 0.0
    (folder / "suite.toml").write_text(SUITE.format(matches=matches))
    (folder / "model.toml").write_text(f'url = "{model.url}"\nname = "{model.name}"\n')
    options = f"--suite suite.toml --model model.toml --out {workers} --workers {workers} --replays none"
    command = [Path(sys.executable).with_name("wildscav"), "evaluate", TALKER, "--sandbox", "bubblewrap"]
    used, began = time_of_children(), time.perf_counter()
    with subprocess.Popen([*command, *options.split()], cwd=folder, stdout=subprocess.DEVNULL) as playing:
        while playing.poll() is None:
            most = max(most, memory(playing.pid))
            time.sleep(1.0)
    if playing.returncode:
        raise RuntimeError(f"the evaluation ended with code {playing.returncode}")
    seconds, used = time.perf_counter() - began, time_of_children() - used
    note = f"{(len(model.requests) - asked) / matches:.1f} answers a match; {seconds:.0f} s in all"
    return [
        Figure(f"{workers} at once: matches", 60.0 * matches / seconds, "a minute", note),
        Figure(f"{workers} at once: memory", most / workers, "MB a match", "of all processes, at most"),
        Figure(f"{workers} at once: processors", used / matches, "s a match"),
    ]


def main(workers: list[int], json: JsonFile = None) -> None:
    """Measure matches that wait for a model."""
    with (
        tempfile.TemporaryDirectory() as folder,
        ScriptedModel(lambda *one: Late(ANSWER, mind(*one))) as model,
    ):
        figures = [figure for number in workers for figure in measure(number, model, Path(folder))]
        publish(f"matches that wait {ANSWER:g} s for each answer", figures, json)


if __name__ == "__main__":
    typer.run(main)
