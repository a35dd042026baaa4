# ruff: noqa: INP001 - a script, not part of a package
"""Make the animation of docs/watching.md: python docs/images/video.py."""

from pathlib import Path

from wildscav_engine.record import record_of
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.view.video.encode import Pace, write_poster, write_video
from wildscav_engine.view.video.film import Film, Look

FOLDER = Path(__file__).parent / "video"
NAMES = ("ada", "bel", "cyd", "dov", "eli", "fay", "gus", "hal", "ida", "jon")
BEFORE, AFTER = 3.0, 2.0  # s around the best moment


def main() -> None:
    """Play a battle, and write an animation and a poster of each view."""
    FOLDER.mkdir(exist_ok=True)
    spec = MatchSpec(track="battle", map=MapSpec(seed=3), seats=("fighter",) * 10, seed=5, time_limit=120.0)
    match = Match(spec)
    match.play_out()
    record = record_of(match, NAMES)
    film = Film(record, Look("follow", width=640, height=360, detail=1.0))
    best = film.best_time
    write_video(film, FOLDER / "follow.webp", Pace(best - BEFORE, best + AFTER, fps=10.0))
    for view in ("overview", "grid"):
        write_poster(Film(record, Look(view, detail=1.0)), FOLDER / f"{view}.webp", best)


if __name__ == "__main__":
    main()
