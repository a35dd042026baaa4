"""Data sets of Minari: HDF5 files in its own folder, which ``minari.load_dataset`` reads."""

import shutil
import warnings
from collections.abc import Iterable, Iterator, Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import minari
from gymnasium.envs.registration import EnvSpec
from minari.data_collector import EpisodeBuffer
from minari.dataset.minari_dataset import parse_dataset_id
from minari.storage.datasets_root_dir import get_dataset_path

from wildscav.errors import UserError
from wildscav.version import __version__
from wildscav_engine.envs.registry import env_id
from wildscav_training.datasets.episodes import Episode, Spaces

SHAPE = "such as navigation/mapper-v0: lower or upper case letters, digits, _ and -, and a version"


class Written(NamedTuple):
    """A data set that was written."""

    id: str
    folder: Path
    episodes: int
    steps: int
    mean_return: float


def check_id(dataset: str) -> None:
    """Raise a UserError for the id of a data set that has another form, or that exists."""
    try:
        parse_dataset_id(dataset)
    except (ValueError, TypeError):  # the latter without a version
        raise UserError(f"--id is {dataset!r}, must be a name and a version, {SHAPE}", exit_code=2) from None
    folder = get_dataset_path(dataset)
    if folder.exists():
        raise UserError(
            f"there is a data set {dataset} already, in {folder}: take another name or version, or delete it "
            f"with: minari delete {dataset}",
            exit_code=2,
        )


def env_spec(track: str, options: Mapping[str, Any], spaces: Spaces) -> EnvSpec | None:
    """Return the environment that ``recover_environment`` makes; None if none has the same observations."""
    # What Gymnasium returns is its registered entry itself, which must stay as it is.
    spec = deepcopy(gymnasium.spec(env_id(track, options["version"])))
    spec.kwargs = {**spec.kwargs, **options}
    try:
        env = gymnasium.make(spec)
    except (TypeError, ValueError):
        return None
    is_same = env.observation_space == spaces.observation
    env.close()
    return spec if is_same else None


def write(
    dataset: str,
    episodes: Iterable[Episode],
    spaces: Spaces,
    spec: EnvSpec | None,
    description: str,
) -> Written:
    """Write a data set episode by episode, or leave nothing and raise a UserError."""
    folder = Path(get_dataset_path(dataset))
    totals = _Totals()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about an author and the like, which stay empty
            made = minari.create_dataset_from_buffers(
                dataset,
                [],
                env=spec,
                description=description,
                observation_space=spaces.observation,
                action_space=spaces.action,
                requirements=[f"wildscav=={__version__}"],
                jpeg_encoding=False,  # it would change pixels
            )
        made.storage.update_episodes(totals.buffers(episodes))
        made.storage.update_episode_metadata(totals.about)
        made.storage.update_metadata({"algorithm_name": ", ".join(totals.agents)})
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    count = len(totals.about)
    return Written(dataset, folder, count, totals.steps, totals.returns / max(count, 1))


class _Totals:
    """Counts episodes while they are written."""

    def __init__(self) -> None:
        self.steps, self.returns = 0, 0.0
        self.about: list[dict[str, Any]] = []
        self.agents: dict[str, None] = {}  # their names, in order

    def buffers(self, episodes: Iterable[Episode]) -> Iterator[EpisodeBuffer]:
        for episode in episodes:
            self.steps += len(episode.rewards)
            self.returns += float(episode.rewards.sum())
            about = dict(episode.about)
            metrics = about.pop("metrics")
            self.agents |= dict.fromkeys(about["agent"].split(", "))
            self.about.append({**about, **{f"metrics/{name}": value for name, value in metrics.items()}})
            yield EpisodeBuffer(
                seed=about.get("env_seed"),
                observations=episode.observations,
                actions=episode.actions,
                rewards=episode.rewards,
                terminations=episode.terminations,
                truncations=episode.truncations,
                infos=episode.infos,
            )
