# ruff: noqa: INP001 - a script, not part of a package
"""Make the pictures of docs/watching.md, of which the README has the first: python docs/images/video.py."""

from pathlib import Path

from wildscav_engine.record import record_of
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.view.video.encode import Pace, write_poster, write_video
from wildscav_engine.view.video.film import Film, Look

FOLDER = Path(__file__).parent / "video"
NAMES = ("ada", "bel", "cyd", "dov", "eli", "fay", "gus", "hal", "ida", "jon")
SPEC = MatchSpec(
    track="battle",
    map=MapSpec(config=MapConfig(size=110, relief=1.6, ruggedness=0.6, water=0.15, houses=7), seed=9),
    seats=(*("fighter-hard",) * 5, *("fighter",) * 3, "gatherer", "gatherer"),
    seed=11,
    time_limit=90.0,
)
BEGIN, END = 0.3, 9.0  # s


def main() -> None:
    """Play a battle, and write an animation and a poster of each view."""
    FOLDER.mkdir(exist_ok=True)
    match = Match(SPEC)
    match.play_out()
    record = record_of(match, NAMES)
    film = Film(record, Look("follow", width=640, height=360, detail=1.0))
    write_video(film, FOLDER / "follow.webp", Pace(BEGIN, END, fps=12.0))
    for view in ("overview", "grid"):
        write_poster(Film(record, Look(view, detail=1.0)), FOLDER / f"{view}.webp", film.best_time)


if __name__ == "__main__":
    main()
