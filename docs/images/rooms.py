# ruff: noqa: INP001 - a script, not part of a package
"""Make rooms.svg, the picture in docs/architecture.md, from the import contracts in pyproject.toml.

python docs/images/rooms.py
"""

import ast
import tomllib
from html import escape
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
PICTURE = Path(__file__).with_name("rooms.svg")

ROWS = (  # from the highest to the lowest, as in the contract of the packages
    {"wildscav_leaderboard": "leaderboard/: the database of results; seasons, the competition as a service"},
    {"wildscav_evaluator": "evaluator/: suites of seeded matches, agents in sandboxes, scores"},
    {"wildscav_inspect": "platform/: looking at worlds and matches"},
    {
        "wildscav_training": "learning",
        "wildscav_stage": "the browser",
        "wildscav_legacy": "the original",
    },
    {"wildscav_server": "platform/: the match server"},
    {"wildscav": "platform/: what an agent needs: the SDK and the protocol; the frame of the command"},
    {"wildscav_engine": "engine/: the simulation, environments, records, replays"},
)
WIDTH, MARGIN, TITLE = 1000, 16, 34  # px
LETTER = 6.6  # px, the width of most letters
ROOM, GAP = 30, 8  # px, the height of a room and the gaps around it
STYLE = """
text { font: 14px system-ui, sans-serif; fill: #1c2733; }
.title { font-weight: 600; }
.what { font-size: 12.5px; opacity: 0.75; }
.package { fill: #eef3f7; stroke: #9fb3c4; }
.room { fill: #ffffff; stroke: #7d97ad; }
.arrow { stroke: #7d97ad; stroke-width: 2; fill: none; }
@media (prefers-color-scheme: dark) {
  text { fill: #e3ebf2; }
  .package { fill: #1b2630; stroke: #48606f; }
  .room { fill: #263643; stroke: #5d7a8c; }
  .arrow { stroke: #5d7a8c; }
}
"""


class Rectangle(NamedTuple):
    """A part of the picture, in px."""

    x: float
    y: float
    width: float
    height: float

    def drawn(self, kind: str) -> str:
        """Return an SVG element of the rectangle, with a class of the style sheet."""
        x, y, width, height = (f"{number:g}" for number in self)
        return f'<rect class="{kind}" x="{x}" y="{y}" width="{width}" height="{height}" rx="6"/>'


def layers_of(package: str) -> list[list[str]]:
    """Return the rooms of a package: one list for each layer of its import contract."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"][
        "contracts"
    ]
    layers = next((each["layers"] for each in contracts if each.get("containers") == [package]), [])
    return [[room.strip("() ") for room in layer.replace(":", "|").split("|")] for layer in layers]


def described(package: str, room: str) -> str:
    """Return the first paragraph of a room's docstring."""
    home = next(ROOT.glob(f"*/{package}")) / room
    file = home / "__init__.py" if home.is_dir() else home.with_suffix(".py")
    said = ast.get_docstring(ast.parse(file.read_text("utf-8"))) or ""
    return said.split("\n\n")[0].replace("\n", " ").replace("`", "")


def label(package: str, room: str, box: Rectangle) -> str:
    """Return a room's name, with its description if there is space for it."""
    name, what = escape(room), described(package, room)
    start = f'x="{box.x + 10:g}" y="{box.y + 20:g}"'
    if (len(room) + len(what) + 4) * LETTER > box.width:
        return f"<text {start}>{name}<title>{escape(what)}</title></text>"
    return f'<text {start}>{name}<tspan class="what" dx="10">{escape(what)}</tspan></text>'


def drawn_row(packages: dict[str, str], top: float) -> tuple[list[str], float]:
    """Return the elements of packages side by side and their lower edge, in px."""
    height = max(TITLE + len(layers_of(package)) * (ROOM + GAP) + GAP for package in packages)
    width = round((WIDTH - MARGIN) / len(packages) - MARGIN, 1)
    parts: list[str] = []
    for number, (package, caption) in enumerate(packages.items()):
        box = Rectangle(MARGIN + number * (width + MARGIN), top, width, height)
        parts += drawn_package(package, caption, box)
    return parts, top + height


def drawn_package(package: str, caption: str, box: Rectangle) -> list[str]:
    """Return a package's elements: its box, its title and its rooms."""
    title = f'<text class="title" x="{box.x + MARGIN:g}" y="{box.y + 23:g}">'
    what = f'<tspan class="what" dx="10">{escape(caption)}</tspan>'
    parts = [box.drawn("package"), f"{title}{package}{what}</text>"]
    for number, rooms in enumerate(layers_of(package)):
        width = (box.width - 2 * MARGIN + GAP) / len(rooms)
        for place, room in enumerate(rooms):
            inner = Rectangle(
                round(box.x + MARGIN + place * width, 1),
                box.y + TITLE + number * (ROOM + GAP),
                round(width - GAP, 1),
                ROOM,
            )
            parts += [inner.drawn("room"), label(package, room, inner)]
    return parts


def picture() -> str:
    """Return the picture as SVG."""
    parts: list[str] = []
    top = float(MARGIN)
    for number, row in enumerate(ROWS):
        if number:
            middle = f"{WIDTH / 2:g}"
            parts.append(f'<path class="arrow" d="M {middle} {top + 4:g} v 20 m -6 -7 l 6 7 l 6 -7"/>')
            top += 28
        drawn, top = drawn_row(row, top)
        parts += drawn
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {top + MARGIN:g}" role="img">',
            "<title>The packages of Wildscav and their folders. Imports go down only.</title>",
            f"<style>{STYLE}</style>",
            *parts,
            "</svg>\n",
        ]
    )


if __name__ == "__main__":
    PICTURE.write_text(picture(), "utf-8")
