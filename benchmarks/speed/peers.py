"""Steps a second compared with ViZDoom in the same run: combat with a depth map in every step.

ViZDoom plays its own deathmatch (``pip install vizdoom``), Wildscav a battle of ten through Gymnasium. They
take turns, so that both see the same load of the machine. A tic of ViZDoom is 1/35 s of game time, a step
of Wildscav 1/10 s.
"""

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import gymnasium
import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish

ROUNDS, STEPS = 7, 400
WIDTH, HEIGHT = 160, 120


def doom() -> Callable[[int], None]:
    """Return a function that plays one tic of ViZDoom's deathmatch and reads its depth map.

    Raises:
        Exit: ViZDoom is not installed.
    """
    try:
        import vizdoom
    except ImportError:
        print("ViZDoom is not installed: pip install vizdoom")
        raise typer.Exit(2) from None
    game = vizdoom.DoomGame()
    game.load_config(str(Path(vizdoom.scenarios_path) / "deathmatch.cfg"))
    game.set_window_visible(False)
    game.set_depth_buffer_enabled(True)
    game.set_screen_resolution(vizdoom.ScreenResolution.RES_160X120)
    game.init()
    random = np.random.default_rng(0)
    buttons = game.get_available_buttons_size()
    actions = [(random.random(buttons) < 0.3).astype(int).tolist() for _ in range(64)]

    def tic(number: int) -> None:
        if game.is_episode_finished():
            game.new_episode()
        game.get_state().depth_buffer.sum()
        game.make_action(actions[number % 64])

    return tic


def wildscav(width: int, height: int) -> Callable[[int], None]:
    """Return a function that plays one step of a battle of ten with a depth map."""
    sensors = {"depth": {"width": width, "height": height}}
    env = gymnasium.make(
        "wildscav_engine:WildScav/Battle-v1", level="easy", random_maps=4, sensors=sensors, action_mode="box"
    )
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(64)]
    env.reset(seed=0)

    def step(number: int) -> None:
        observation, _, terminated, truncated, _ = env.step(actions[number % 64])
        observation["depth"].sum()
        if terminated or truncated:
            env.reset()

    return step


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    peer = f"ViZDoom deathmatch, {WIDTH} × {HEIGHT} depth"
    players = {
        peer: doom(),
        f"battle of ten, {WIDTH} × {HEIGHT} depth": wildscav(WIDTH, HEIGHT),
        "battle of ten, 10 × 10 depth": wildscav(10, 10),
    }
    rates: dict[str, list[float]] = {name: [] for name in players}
    for _ in range(ROUNDS + 1):
        for name, play in players.items():
            started = time.perf_counter()
            for number in range(STEPS):
                play(number)
            rates[name].append(STEPS / (time.perf_counter() - started))
    medians = {name: statistics.median(values[1:]) for name, values in rates.items()}
    figures = [
        Figure(name, rate, "steps/s", f"{rate / medians[peer]:.1f} ×") for name, rate in medians.items()
    ]
    publish("Compared with ViZDoom: steps a second, one process", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
