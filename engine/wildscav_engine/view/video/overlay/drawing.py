"""Text, bars and marks with smooth edges, each drawn once and kept."""

from functools import lru_cache
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw, ImageFont

if TYPE_CHECKING:
    from PIL.ImageFont import FreeTypeFont

Color = tuple[int, int, int]

WHITE, SOFT, DARK = (255, 255, 255), (196, 204, 214), (12, 16, 22)
PANEL = (*DARK, 168)  # of what lies below text
FINER = 4  # samples along each side of a pixel of a mark
# Corners of an arrowhead that points up, from its middle, in units of its length.
ARROWHEAD = ((0.0, -1.0), (0.72, 0.8), (0.0, 0.42), (-0.72, 0.8))
ELLIPSIS = "…"
HEALTHY, HURT, DYING = (112, 208, 96), (244, 190, 64), (240, 84, 66)


@lru_cache(maxsize=16)
def font(size: int) -> "FreeTypeFont":
    """Return Pillow's own font, at a height in pixels."""
    made = ImageFont.load_default(size)
    if not isinstance(made, ImageFont.FreeTypeFont):
        raise OSError("this Pillow was built without FreeType, which draws text")
    return made


@lru_cache(maxsize=2048)
def text(line: str, size: int, color: Color = WHITE, widest: int = 0) -> Image.Image:
    """Return a line with a dark edge, no wider than ``widest`` pixels (0: as wide as it is)."""
    line = shortened(line, size, widest)
    left, _, right, _ = font(size).getbbox(line)
    edge = max(1, size // 14)
    picture = Image.new("RGBA", (int(right - left) + 2 * edge + 1, round(1.3 * size) + 2 * edge))
    draw = ImageDraw.Draw(picture)
    draw.text((edge - left, edge), line, color, font(size), stroke_width=edge, stroke_fill=(*DARK, 150))
    draw.text((edge - left, edge), line, color, font(size))
    return picture


@lru_cache(maxsize=2048)
def shortened(line: str, size: int, widest: int) -> str:
    """Return as much of a line as fits into some pixels; 0 for all of it."""
    line = " ".join(line.split())
    if not widest or font(size).getlength(line) <= widest:
        return line
    while line and font(size).getlength(line + ELLIPSIS) > widest:
        line = line[:-1]
    return line.rstrip() + ELLIPSIS


@lru_cache(maxsize=64)
def panel(width: int, height: int, round_by: int = 6) -> Image.Image:
    """Return a dark translucent rectangle with round corners."""
    picture = Image.new("RGBA", (width, height))
    ImageDraw.Draw(picture).rounded_rectangle((0, 0, width - 1, height - 1), round_by, PANEL)
    return picture


@lru_cache(maxsize=1024)
def bar(width: int, height: int, filled: int, color: Color) -> Image.Image:
    """Return a bar of which ``filled`` pixels of the width have a colour."""
    picture = Image.new("RGBA", (width, height), (*DARK, 200))
    if filled > 0:
        picture.paste((*color, 255), (1, 1, 1 + min(filled, width - 2), height - 1))
    return picture


def health_bar(width: int, height: int, share: float) -> Image.Image:
    """Return a bar for a share of the full health."""
    color = HEALTHY if share > 0.6 else HURT if share > 0.3 else DYING
    return bar(width, height, round(min(1.0, share) * (width - 2)), color)


@lru_cache(maxsize=2048)
def arrowhead(size: int, turn: int, color: Color) -> Image.Image:
    """Return a mark that points ``turn`` degrees clockwise from above, about ``size`` pixels long."""
    side = 2 * size * FINER
    picture = Image.new("RGBA", (side, side))
    draw = ImageDraw.Draw(picture)
    for reach, fill in ((0.48, DARK), (0.36, color)):
        corners = [(side / 2 + x * side * reach, side / 2 + y * side * reach) for x, y in ARROWHEAD]
        draw.polygon(corners, (*fill, 255))
    return picture.rotate(-turn, Image.Resampling.BICUBIC).resize((2 * size, 2 * size), Image.Resampling.BOX)


@lru_cache(maxsize=64)
def dot(size: int, color: Color) -> Image.Image:
    """Return a round mark with a dark edge, ``size`` pixels wide."""
    side = size * FINER
    picture = Image.new("RGBA", (side, side))
    ImageDraw.Draw(picture).ellipse((0, 0, side - 1, side - 1), (*color, 255), (*DARK, 255), FINER)
    return picture.resize((size, size), Image.Resampling.BOX)


def put(picture: Image.Image, patch: Image.Image, x: float, y: float, *, anchor: str = "lt") -> None:
    """Lay a patch over a picture.

    Args:
        anchor: Which point of the patch lies there: left, middle or right, then top, middle or bottom.
    """
    width, height = patch.size
    left = x - {"l": 0.0, "m": width / 2, "r": float(width)}[anchor[0]]
    top = y - {"t": 0.0, "m": height / 2, "b": float(height)}[anchor[1]]
    picture.paste(patch, (round(left), round(top)), patch)
