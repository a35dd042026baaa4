"""The home page: the README with a match that plays in it, and a card of links for each kind of reader."""

import functools
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from wildscav_engine.record import record_of
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_stage.watching.match_page import scene_of_record, whole_page

MATCH = "assets/match.html"
SPEC = MatchSpec(
    track="battle",
    map=MapSpec(config=MapConfig(size=100, relief=1.2, ruggedness=0.6, water=0.1, houses=6), seed=12),
    seats=(*("fighter-hard",) * 3, "fighter", "gatherer", "gatherer"),
    time_limit=60.0,
    seed=5,
)
PICTURE = re.compile(r"^!\[.*\)$", re.MULTILINE)
IN_PAGE = f'<iframe class="match" src="{MATCH}" title="A battle of six robots in 3D"></iframe>'


@functools.cache  # mkdocs serve builds the site again and again
def match_page() -> str:
    """Return a page on which a battle of robots plays."""
    match = Match(SPEC)
    match.play_out()
    names = [f"{kind} {seat + 1}" for seat, kind in enumerate(SPEC.seats)]
    return whole_page(scene_of_record(record_of(match, names)))


def with_readers(readme: str, nav: Sequence[Mapping[str, Any]]) -> str:
    """Return the README with a card for each part of the navigation, and a match in place of its picture.

    Args:
        readme: The text.
        nav: The navigation from ``mkdocs.yml``.
    """
    opening, heading, rest = readme.partition("\n## ")
    opening = PICTURE.sub(IN_PAGE, opening, count=1)
    cards = [
        f"-   **{title}**\n\n    {' · '.join(_links(pages))}\n"
        for part in nav
        for title, pages in part.items()
        if not isinstance(pages, str)
    ]
    return "\n".join([opening, '<div class="grid cards" markdown>\n', *cards, "</div>\n", heading + rest])


def _links(pages: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Return a link to each page of a part, and to the first page of each nested part."""
    for entry in pages:
        for title, target in entry.items():
            yield f"[{title}]({_first(target)})"


def _first(target: Any) -> str:
    """Return a page, or the first page of a part."""
    return target if isinstance(target, str) else _first(next(iter(target[0].values())))
