"""A submission as an opponent in training environments."""

import importlib
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import ACTION_FIELDS, Agent, check_action
from wildscav.baselines import baseline_folder, is_baseline
from wildscav.errors import AgentError, UserError
from wildscav.sdk.run import make_agent
from wildscav.sdk.submission_folder import MANIFEST, load_agent_class
from wildscav.terminal.suggestions import did_you_mean
from wildscav.wire.actions import decode_action, encode_action
from wildscav_engine.envs import SeatController
from wildscav_engine.sensors import allowed_sensors, parse_sensors
from wildscav_server.hosting.manifest import Manifest, check_plays_numbers, read_manifest
from wildscav_server.time_limits import Clock
from wildscav_training.opponents.seat_messages import Indices, decode_for_agent, seat_info, seat_observations

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch


class SubmissionOpponent(SeatController):
    """Plays a submission's agents in this process, one object for each seat and match.

    Each agent is told exactly what it is told over gRPC: the same match info with the same private seed, the
    same observations with the sensors of its own manifest, and its actions are checked and rounded in the
    same way. Only its clock stands still, so the time bank of its observations stays full.
    """

    def __init__(self, folder: str | Path) -> None:
        """Load a submission from its folder, or from the name of a baseline, such as "hunter".

        Its code runs with all rights of this process.

        Raises:
            UserError: The folder is not a submission in Python that plays by numbers, or its code cannot be
                imported.
        """
        self.folder = _checked_folder(folder)
        manifest = read_manifest(self.folder / MANIFEST)
        self.name, self._tracks = manifest.name, manifest.tracks
        self._sensors = parse_sensors(manifest.sensors)
        self._modules = OwnModules(self.folder)
        self._class = self._load(manifest)
        self._agents: dict[tuple[int, int], Agent] = {}  # by match and seat
        self._banks: dict[tuple[int, int], float] = {}  # s, the time bank of each
        self._clock = Clock()

    def __reduce__(self) -> tuple[type["SubmissionOpponent"], tuple[Path]]:
        """Load it anew in another process; matches that it plays stay behind."""
        return type(self), (self.folder,)

    def _load(self, manifest: Manifest) -> Callable[[], Agent]:
        check_plays_numbers(self.folder / MANIFEST, manifest)
        return self._class_in(manifest)

    def _class_in(self, manifest: Manifest) -> Callable[[], Any]:
        """Import the class of an entry point."""
        if manifest.entry_point is None:
            raise UserError(
                f"{self.folder / MANIFEST} has a command, so the agent is a program of its own; "
                "only agents in Python, with an entry_point, can play in an environment",
                exit_code=2,
            )
        try:
            with self._modules:
                return load_agent_class(manifest.entry_point)
        except UserError:
            raise
        except Exception as error:
            raise UserError(
                f"the code of {self.folder} cannot be imported: {type(error).__name__}: {error}", exit_code=2
            ) from error

    def check(self, track: str) -> None:
        """Raise a ValueError if the submission does not play a track."""
        if track not in self._tracks:
            raise ValueError(
                f"the submission {self.name} plays {', '.join(self._tracks)}, not {track}: "
                f"see tracks in {self.folder / MANIFEST}"
            )

    def begin(self, batch: "Batch", matches: Indices, seats: Indices) -> None:
        """Begin new episodes with new agents; an AgentError if one fails. See ``SeatController.begin``."""
        for match, seat in zip(matches.tolist(), seats.tolist(), strict=True):
            self.check(batch.specs[match].track)
            info = seat_info(batch, match, seat, self._clock)
            with self._modules:
                agent = self._call("its constructor", match, seat, make_agent, self._class)
                self._call("reset", match, seat, agent.reset, info)
            self._agents[match, seat], self._banks[match, seat] = agent, info.time_bank

    def act(self, batch: "Batch", matches: Indices, seats: Indices) -> NDArray[np.float32]:
        """Return (N, FIELDS) rows of actions. See ``SeatController.act``.

        Raises:
            AgentError: An agent's code failed, or returned something that is not an action.
        """
        pairs = list(zip(matches.tolist(), seats.tolist(), strict=True))
        banks = np.array([self._banks[pair] for pair in pairs])
        encoded = seat_observations(batch, matches, seats, banks)
        outside = [column for column in range(len(ACTION_FIELDS)) if column not in batch.track.fields]
        rows = np.zeros((len(seats), len(ACTION_FIELDS)), np.float32)
        sensors = allowed_sensors(self._sensors, batch.rules)
        with self._modules:
            for index, (match, seat) in enumerate(pairs):
                observation = decode_for_agent(encoded[index], sensors, batch, match, seat)
                agent = self._agents[match, seat]
                answer = self._call("act", match, seat, agent.act, observation)
                message = encode_action(observation.step, check_action(agent, answer))
                decoded = decode_action(message.action, outside)
                if decoded.row is not None:
                    rows[index] = decoded.row
        return rows

    def _call(self, what: str, match: int, seat: int, work: Callable[..., Any], given: object) -> Any:
        """Call the agent's code."""
        try:
            return work(given)
        except AgentError:
            raise
        except Exception as error:
            raise AgentError(
                f"the submission {self.name} failed in {what} (match {match}, seat {seat}): "
                f"{type(error).__name__}: {error}"
            ) from error


def submission(folder: str | Path) -> SubmissionOpponent:
    """Return a submission as an opponent for ``opponents`` of an environment.

    Args:
        folder: The submission's folder, or the name of a baseline, such as "hunter". Its code runs in this
            process, with all of its rights.

    Raises:
        UserError: The folder is not a submission in Python, or its code cannot be imported.
    """
    return SubmissionOpponent(folder)


def _checked_folder(given: str | Path) -> Path:
    """Return the absolute path of a submission's folder."""
    folder = baseline_folder(str(given)) if is_baseline(str(given)) else Path(given)
    if (folder / MANIFEST).is_file():
        return folder.resolve()
    if folder.is_dir():
        raise UserError(f"{folder / MANIFEST} is missing: a submission is a folder with one", exit_code=2)
    beside = folder.parent.iterdir() if folder.parent.is_dir() else ()
    near = did_you_mean(folder.name, [other.name for other in beside if (other / MANIFEST).is_file()])
    what = "is not a folder" if folder.exists() else "does not exist"
    raise UserError(f"submission {folder} {what}{near}: give a folder with a {MANIFEST} in it", exit_code=2)


class OwnModules:
    """The modules in a submission's folder, which only its own code can import.

    All submissions have a module ``agent``, and many have others of equal names. So a submission's code runs
    inside this context. It puts the folder first on the path and the submission's modules into
    ``sys.modules``, and takes both out again at the end. Only one thread at a time can be inside.
    """

    _one_at_a_time: ClassVar[threading.RLock] = threading.RLock()

    def __init__(self, folder: Path) -> None:
        self._folder = str(folder)
        self._names = {
            path.stem for path in folder.iterdir() if path.suffix == ".py" or (path / "__init__.py").is_file()
        }
        self._own: dict[str, ModuleType] = {}
        self._displaced: dict[str, ModuleType] = {}
        self._count = 0
        importlib.invalidate_caches()

    def __enter__(self) -> None:
        self._one_at_a_time.acquire()
        self._displaced = {
            name: sys.modules.pop(name) for name in self._names | self._own.keys() if name in sys.modules
        }
        sys.modules.update(self._own)
        self._count = len(sys.modules)
        sys.path.insert(0, self._folder)

    def __exit__(self, *_: object) -> None:
        if len(sys.modules) != self._count:
            modules = list(sys.modules.items())
            self._own = {name: found for name, found in modules if name.partition(".")[0] in self._names}
        for name in self._own:
            sys.modules.pop(name, None)
        sys.modules.update(self._displaced)
        if self._folder in sys.path:
            sys.path.remove(self._folder)
        self._one_at_a_time.release()
