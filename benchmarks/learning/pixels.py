"""Learning from pictures: navigation with a camera of 84 × 84 pixels and a convolutional network.

    python -m benchmarks.learning.pixels --seeds 0

trains PPO of Stable-Baselines3 with its network for pictures (NatureCNN) on the level easy and measures it on
100 maps that it has not seen, beside the same learner whose network sees no picture. Both also know the
direction and the distance of the target, which no picture shows. It adds what is not yet in the folder of
results, and prints the table of all that is there; with ``--seeds ''`` it only does that.
"""

import statistics
import sys
import time
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import torch
import typer
from benchmarks.learning.result_files import add, numbers, results_in
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecNormalize

from wildscav_engine.envs import StableVector
from wildscav_training.trials import rate

RESULTS = Path(__file__).parent / "results" / "pixels"
MATCHES, STEPS, EPISODES = 64, 160_000, 100
SENSORS: dict[str, dict[str, Any]] = {"camera 84 × 84": {"camera": {"width": 84, "height": 84}}, "none": {}}
OPTIONS: dict[str, Any] = {
    "version": 1,
    "level": "easy",
    "random_maps": 24,
    "action_mode": "multidiscrete",
    "frames_per_action": 15,
    "time_limit": 60.0,
    "rewards": {"target_reached": 1.0, "approach": 0.01},
}


def model_of(sees: str, seed: int) -> PPO:
    """Return a learner that knows nothing yet."""
    envs = scaled(StableVector("navigation", MATCHES, sensors=SENSORS[sees], **OPTIONS))
    given: dict[str, Any] = {"n_steps": 64, "batch_size": 256, "n_epochs": 4, "learning_rate": 5e-4}
    return PPO("MultiInputPolicy", envs, **given, ent_coef=0.003, device="cpu", seed=seed)


def scaled(envs: StableVector) -> VecNormalize:
    """Return environments whose numbers have a mean of 0 and a deviation of 1; pictures stay as they are."""
    spaces: Any = envs.observation_space
    return VecNormalize(envs, norm_reward=False, norm_obs_keys=[name for name in spaces if name != "camera"])


def played(model: PPO, sees: str) -> list[bool]:
    """Return which of the test episodes reached their targets; each is the first of its row."""
    envs = StableVector(
        "navigation", EPISODES, sensors=SENSORS[sees], split="test", **{**OPTIONS, "random_maps": EPISODES}
    )
    envs, known = scaled(envs), model.get_vec_normalize_env()
    envs.obs_rms, envs.training = known.obs_rms, False
    seen: Any = envs.reset()
    found: dict[int, bool] = {}
    while len(found) < EPISODES:
        actions, _ = model.predict(seen, deterministic=False)
        seen, _, done, infos = envs.step(actions)
        for row in np.flatnonzero(done).tolist():
            found.setdefault(row, bool(infos[row]["metrics"]["success"]))
    return [found[row] for row in range(EPISODES)]


def trained(sees: str, seed: int) -> dict[str, Any]:
    """Train a policy and measure it."""
    model = model_of(sees, seed)
    began = time.process_time()
    model.learn(STEPS)
    seconds = time.process_time() - began
    return {
        "sees": sees,
        "seed": seed,
        "steps": model.num_timesteps,
        "cpu_seconds": round(seconds, 1),
        "success": played(model, sees),
    }


def table(results: list[Any]) -> str:
    """Return a row for each network, in Markdown."""
    rows = ["| pictures | success on unseen maps | seeds | steps | CPU s |\n|---|---|---|---|---|\n"]
    for sees in SENSORS:
        runs = [run for run in results if run["sees"] == sees]
        if runs:
            success = rate([one for run in runs for one in run["success"]])
            seconds = statistics.fmean(run["cpu_seconds"] for run in runs)
            rows.append(f"| {sees} | {success} | {len(runs)} | {runs[0]['steps']:,} | {seconds:.0f} |\n")
    return "".join(rows)


def main(
    seeds: Annotated[str, typer.Option(help="Seeds of the runs.")] = "0",
    out: Annotated[Path, typer.Option(help="Folder of the results.")] = RESULTS,
) -> None:
    """Train what is missing, and print the table."""
    torch.set_num_threads(1)
    for seed in numbers(seeds):
        for place, sees in enumerate(SENSORS):
            add(out / f"{place}-seed-{seed}.json", partial(trained, sees, seed))
    sys.stdout.write(table(results_in(out)))


if __name__ == "__main__":
    typer.run(main)
