# ruff: noqa: INP001 - a script, not part of a package
"""Make the pictures on the environments' pages: what a learner sees, and beside it the match from above.

    python docs/images/environments.py

needs ``pip install 'wildscav[maps]'``. Run it again whenever the version of the map generator or of the
simulation rises.
"""

import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from PIL import Image

FOLDER = Path(__file__).parent / "environments"
HEIGHT = 450  # pixels of both pictures
EYES, TOP = (800, HEIGHT), (HEIGHT, HEIGHT)
GAP, QUALITY = 8, 86  # pixels between the two pictures; quality of the JPEG
COUNTRY: dict[str, Any] = {"size": 120, "relief": 1.2, "ruggedness": 0.5, "water": 0.16, "houses": 5}
COUNTRY |= {"storeys": (2, 3), "vegetation": 0.55}
OPTIONS: dict[str, dict[str, Any]] = {
    "Navigation": {},
    "Gathering": {"opponents": ("gatherer",) * 3},
    "Capture": {"teammates": ("seeker",) * 3},
    "Battle": {},
    "Royale": {},
}
for _options in OPTIONS.values():
    _options["map"] = {"config": COUNTRY, "seed": 5}
# Episodes to choose the moments from, so that no two pictures show the same place.
SEEDS = {"Navigation": (1, 2, 3), "Gathering": (4,), "Capture": (9,), "Battle": (16,), "Royale": (19,)}
STEPS = 300  # of an episode, at most
NEAR, FAR = 4.0, 18.0  # m, the distances at which agents and boxes make a good picture
ANGLE = 30.0  # degrees that they are off the middle of the view, at most


def main() -> None:
    """Make all pictures and print their sizes."""
    FOLDER.mkdir(exist_ok=True)
    for name, options in OPTIONS.items():
        seed, step = best_moment(name, options)
        eyes, top = (picture(name, options, view, seed, step) for view in ("eyes", "top"))
        both = Image.new("RGB", (EYES[0] + GAP + TOP[0], HEIGHT), "white")
        both.paste(eyes, (0, 0))
        both.paste(top, (EYES[0] + GAP, 0))
        path = FOLDER / f"{name.lower()}.jpg"
        both.save(path, quality=QUALITY, optimize=True)
        sys.stdout.write(f"{path.name}: seed {seed}, step {step}, {path.stat().st_size / 1e3:.0f} kB\n")


def best_moment(name: str, options: dict[str, Any]) -> tuple[int, int]:
    """Return the seed and the step with the highest score for a picture."""
    best, moment = -1.0, (1, 0)
    env = gymnasium.make(f"wildscav_engine:WildScav/{name}-v1", **options)
    for seed in SEEDS[name]:
        observation, _ = env.reset(seed=seed)
        for step in range(STEPS):
            score = picture_score(observation)
            if score > best:
                best, moment = score, (seed, step)
            observation, _, terminated, truncated, _ = env.step(choose(observation))
            if terminated or truncated:
                break
    env.close()
    return moment


def picture_score(observation: dict[str, NDArray[Any]]) -> float:
    """Return the score of an observation for a picture: for agents and boxes ahead, and for open country."""
    found = 0.0
    for name, first, value in (
        ("visible_agents", 3, 6.0),
        ("nearby_supplies", 2, 1.0),
        ("teammates", 2, 6.0),
    ):
        for row in observation.get(name, ()):
            x, _, z, distance = row[first : first + 4]
            ahead = abs(_angle(np.degrees(np.arctan2(x, z)) - observation["view"][0])) < ANGLE
            found += value * (row[0] > 0 and ahead and NEAR < distance < FAR)
    depth = observation["depth"]
    scenery = ((depth > 6.0) & (depth < 70.0))[1:5].mean()
    standing = observation["body"][0] * observation["body"][1]
    return (found + 4.0 * float(scenery)) * float(standing) * float((depth > NEAR).mean() > 0.8)


def choose(observation: dict[str, NDArray[Any]]) -> dict[str, Any]:
    """Walk towards the target, an agent or a box, or else in a wide curve, and turn in that direction."""
    yaw = float(observation["view"][0])
    direction = yaw + 10.0
    if "target" in observation and observation["target"][0] > 0:
        x, _, z = observation["target"][4:7]
        direction = float(np.degrees(np.arctan2(x, z)))
    for name, first in (("visible_agents", 3), ("nearby_supplies", 2)):
        rows = observation.get(name)
        if rows is not None and rows[0, 0] > 0:
            direction = float(np.degrees(np.arctan2(rows[0, first], rows[0, first + 2])))
    turn = float(np.clip(_angle(direction - yaw) / 5, -9, 9))
    action = {"walk_direction": np.float32(direction % 360), "walk_speed": 4, "turn": np.float32(turn)}
    action |= {"look": np.float32(0.0), "jump": 0}
    if "supplies" in observation:
        action["pick_up"] = 0
    if "weapon" in observation:
        action |= {"shoot": 0, "reload": 0}
    return action


def picture(name: str, options: dict[str, Any], view: str, seed: int, step: int) -> Image.Image:
    """Play an episode up to a step and return its rendered picture."""
    size = EYES if view == "eyes" else TOP
    larger = 2  # rendered larger and scaled down, for smooth edges
    env = gymnasium.make(
        f"wildscav_engine:WildScav/{name}-v1",
        render_mode="rgb_array",
        render_view=view,
        render_size=(size[0] * larger, size[1] * larger),
        **options,
    )
    observation, _ = env.reset(seed=seed)
    for _ in range(step):
        observation, *_ = env.step(choose(observation))
    shown: Any = env.render()
    env.close()
    return Image.fromarray(shown).resize(size, Image.Resampling.LANCZOS)


def _angle(degrees: float) -> float:
    """Return an angle in [-180, 180)."""
    return (degrees + 180.0) % 360.0 - 180.0


if __name__ == "__main__":
    main()
