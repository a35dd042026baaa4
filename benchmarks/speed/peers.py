"""Steps a second compared with ViZDoom in the same run: combat with an image in every step.

ViZDoom plays its own deathmatch (``pip install vizdoom``), four tics a step as learners have it, Wildscav a
battle of ten as one Gymnasium environment, with no sensor but the measured one. They take turns, so that all
see the same load of the machine. A tic of ViZDoom is 1/35 s of game time, a step of Wildscav 1/10 s.
"""

from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, in_turns, many, publish
from benchmarks.speed.environments import one_env

ROUNDS, STEPS, TICS = 7, 300, 4
WIDTH, HEIGHT = 160, 120
DEPTH, COLOR = "ViZDoom deathmatch, RGB and depth", "ViZDoom deathmatch, RGB"
SIZE = {"width": WIDTH, "height": HEIGHT}
# Of each battle: the peer that it is compared with, and its sensor.
BATTLES: dict[str, tuple[str, dict[str, Any]]] = {
    "depth": (DEPTH, {"depth": SIZE}),
    "depth of 10 × 10": (DEPTH, {"depth": {"width": 10, "height": 10}}),
    "camera": (COLOR, {"camera": SIZE}),
    "camera without shadows": (COLOR, {"camera": {**SIZE, "shadows": False}}),
    "fast camera": (COLOR, {"camera": {**SIZE, "quality": "fast"}}),
    "fast camera without shadows": (COLOR, {"camera": {**SIZE, "quality": "fast", "shadows": False}}),
}
Play = Callable[[int], None]


def doom(closing: ExitStack, folder: Path, *, with_depth: bool) -> Play:
    """Return a function that plays a step of ViZDoom's deathmatch and reads its images.

    Raises:
        Exit: ViZDoom is not installed.
    """
    try:
        import vizdoom
    except ImportError:
        print("ViZDoom is not installed: pip install vizdoom")
        raise typer.Exit(2) from None
    game = vizdoom.DoomGame()
    game.set_doom_config_path(str(folder / "vizdoom.ini"))
    game.load_config(str(Path(vizdoom.scenarios_path) / "deathmatch.cfg"))
    game.set_window_visible(False)
    game.set_screen_format(vizdoom.ScreenFormat.RGB24)
    game.set_depth_buffer_enabled(with_depth)
    game.set_screen_resolution(vizdoom.ScreenResolution.RES_160X120)
    game.init()
    closing.callback(game.close)
    random = np.random.default_rng(0)
    buttons = game.get_available_buttons_size()
    actions = [(random.random(buttons) < 0.3).astype(int).tolist() for _ in range(64)]

    def step(number: int) -> None:
        if game.is_episode_finished():
            game.new_episode()
        state = game.get_state()
        _ = state.screen_buffer, state.depth_buffer
        game.make_action(actions[number % 64], TICS)

    return step


def wildscav(sensors: dict[str, Any]) -> Play:
    """Return a function that plays a step of a battle of ten with a sensor."""
    return one_env("Battle", {"level": "easy", "random_maps": 4, "sensors": sensors, "action_mode": "box"})


def rates_of(players: dict[str, Play]) -> dict[str, float]:
    """Return the steps a second of each player: the median of rounds in which they take turns."""
    taken = in_turns([many(play, STEPS) for play in players.values()], ROUNDS)
    return dict(zip(players, (STEPS / np.median(taken, axis=0)).tolist(), strict=True))


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    with TemporaryDirectory() as folder, ExitStack() as closing:
        peers = {name: doom(closing, Path(folder), with_depth=name == DEPTH) for name in (DEPTH, COLOR)}
        battles = {name: wildscav(sensors) for name, (_, sensors) in BATTLES.items()}
        rates = rates_of(peers | battles)
    figures = [Figure(name, rates[name], "steps/s") for name in peers]
    for name, (peer, _) in BATTLES.items():
        figures.append(
            Figure(f"battle of ten, {name}", rates[name], "steps/s", f"{rates[name] / rates[peer]:.2f} ×")
        )
    publish(f"Compared with ViZDoom: {WIDTH} × {HEIGHT} pixels, one environment", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
