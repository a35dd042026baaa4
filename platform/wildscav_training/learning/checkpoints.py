"""The folder of a run: its settings, its figures, and checkpoints to continue from.

- ``settings.json``: the settings of the run;
- ``checkpoint.pt``: everything that its next iteration depends on, replaced as a whole;
- ``figures.jsonl``: a JSON object with the figures of each iteration;
- ``policy.npz``: the weights of the trained policy, which NumPy reads;
- ``result.json``: steps, times and scores at the end.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from wildscav.errors import UserError, describe
from wildscav_engine.storage.files import part_of
from wildscav_training.learning.settings import TrainingSettings

SETTINGS, CHECKPOINT, FIGURES = "settings.json", "checkpoint.pt", "figures.jsonl"
WEIGHTS, RESULT = "policy.npz", "result.json"
SHOWN = 60  # characters of a value in an error


class RunFolder:
    """The folder of one run."""

    def __init__(self, path: Path) -> None:
        """Name a folder; nothing is read or written yet."""
        self.path = path

    @property
    def has_checkpoint(self) -> bool:
        """Whether there is something to continue from."""
        return (self.path / CHECKPOINT).is_file()

    def begin(self, settings: TrainingSettings, *, resume: bool) -> None:
        """Make the folder of a new run, or with ``resume`` find one whose run has the same settings.

        Raises:
            UserError: It has files and is not to be resumed, or its run has other settings.
        """
        if self.path.exists() and (not self.path.is_dir() or any(self.path.iterdir())):
            if not resume:
                raise UserError(
                    f"{self.path} is not an empty folder: name another with --out, or continue its run with "
                    "--resume",
                    exit_code=2,
                )
            self._check(settings.as_json())
            return
        self.path.mkdir(parents=True, exist_ok=True)
        write_json(self.path / SETTINGS, settings.as_json())

    def _check(self, now: Mapping[str, Any]) -> None:
        """Compare settings with those of the run in the folder."""
        then = read_json(self.path / SETTINGS)
        for name, before, after in _differences("", then, json.loads(json.dumps(now))):
            raise UserError(
                f"{self.path} holds a run with other settings: {name} is {_short(before)} there and "
                f"{_short(after)} here",
                exit_code=2,
            )

    def append_figures(self, figures: Mapping[str, float]) -> None:
        """Add the figures of an iteration."""
        with (self.path / FIGURES).open("a", encoding="utf-8") as file:
            file.write(json.dumps(figures) + "\n")

    def forget_figures_after(self, steps: int) -> None:
        """Remove the figures of iterations that will be played again."""
        path = self.path / FIGURES
        lines = path.read_text("utf-8").splitlines() if path.is_file() else []
        kept = [line for line in lines if _steps_of(line) <= steps]
        path.write_text("".join(f"{line}\n" for line in kept), "utf-8")

    def save(self, state: Mapping[str, Any]) -> None:
        """Replace the checkpoint; an interruption leaves the one before."""
        import torch

        with part_of(self.path / CHECKPOINT) as part:
            torch.save(dict(state), part)

    def load(self) -> dict[str, Any]:
        """Return the checkpoint, or raise a UserError if it is damaged. No code is run to read it."""
        import torch

        path = self.path / CHECKPOINT
        try:
            state = torch.load(path, weights_only=True)
        except OSError as error:
            raise UserError(describe(error)) from None
        except Exception as error:  # noqa: BLE001 - a damaged file can raise anything
            first = str(error).partition("\n")[0]
            raise UserError(f"{path} is not a checkpoint, or is damaged: {first}") from None
        return dict(state)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """Write a JSON file."""
    path.write_text(json.dumps(content, indent=1) + "\n", "utf-8")


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON object that a run wrote, or raise a UserError if there is none."""
    try:
        content = json.loads(path.read_text("utf-8"))
    except OSError:
        raise UserError(f"{path.parent} holds no run: {path.name} is missing", exit_code=2) from None
    except ValueError as error:
        raise UserError(f"{path} is not valid JSON: {error}", exit_code=2) from None
    if not isinstance(content, dict):
        raise UserError(f"{path} must hold a JSON object", exit_code=2)
    return content


def _differences(prefix: str, before: Mapping[str, Any], after: Mapping[str, Any]) -> Any:
    """Yield the name, the value before and the value after of each setting that differs."""
    for name in {**before, **after}:
        one, other = before.get(name), after.get(name)
        if isinstance(one, dict) and isinstance(other, dict):
            yield from _differences(f"{prefix}{name}.", one, other)
        elif one != other:
            yield f"{prefix}{name}", one, other


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}…"


def _steps_of(line: str) -> float:
    try:
        return float(json.loads(line)["steps"])
    except (ValueError, KeyError, TypeError):
        return float("inf")  # written in part
