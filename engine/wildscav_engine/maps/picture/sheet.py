"""The sheet around a map's picture: title, frame with coordinates, legend, scale bar and north arrow."""

from typing import NamedTuple

from PIL import Image, ImageDraw, ImageFont

from wildscav_engine.maps.picture.paint import PAPER
from wildscav_engine.maps.picture.top_view import Window

INK, SOFT_INK = (44, 40, 38), (120, 112, 104)
OUTLINE = (52, 38, 34)
BASE_WIDTH = 1200  # pixels; everything scales with the width of the sheet
MARGIN, TITLE, FOOT, LABELS = 34, 56, 66, 26  # at that width: around the map, above, below, for coordinates
TEXT, TITLE_TEXT, SMALL_TEXT = 16, 24, 13


class Entry(NamedTuple):
    """One line of the legend."""

    text: str
    color: tuple[int, int, int]
    shape: str  # "house", "patch", "round", "dot" or "line"


class Layout(NamedTuple):
    """The layout of a sheet, in pixels."""

    scale: float  # of everything, 1 at the base width
    left: int
    top: int
    columns: int  # of the map
    rows: int

    def pixels(self, at_base_width: float) -> int:
        """Return a length at this sheet's scale, at least a pixel."""
        return max(1, round(at_base_width * self.scale))


def lay_out(width: int, aspect: float) -> Layout:
    """Return the layout of a sheet of a width, for a map whose height is ``aspect`` times its width."""
    scale = width / BASE_WIDTH
    left = round((MARGIN + LABELS) * scale)
    columns = width - left - round(MARGIN * scale)
    return Layout(scale, left, round(TITLE * scale), columns, max(1, round(columns * aspect)))


def print_sheet(
    picture: Image.Image, layout: Layout, window: Window, title: str, note: str, legend: list[Entry]
) -> Image.Image:
    """Return a sheet with a map's picture."""
    width = layout.left + layout.columns + layout.pixels(MARGIN)
    lines = _wrapped(legend, layout)
    foot = layout.pixels(LABELS + FOOT + 26 * (len(lines) - 1))
    sheet = Image.new("RGB", (width, layout.top + layout.rows + foot), PAPER)
    sheet.paste(picture, (layout.left, layout.top))
    draw = ImageDraw.Draw(sheet)
    right, bottom = layout.left + layout.columns, layout.top + layout.rows
    thick = layout.pixels(1.5)
    draw.rectangle(
        (layout.left - thick, layout.top - thick, right + thick - 1, bottom + thick - 1), None, INK, thick
    )
    _title(draw, layout, title, note)
    _coordinates(draw, layout, window)
    _scale_bar(draw, layout, window)
    _legend(draw, layout, lines)
    _north_arrow(sheet, layout)
    return sheet


def font(layout: Layout, size: float) -> ImageFont.ImageFont | ImageFont.FreeTypeFont:
    """Return Pillow's own font at a size in pixels at the base width."""
    return ImageFont.load_default(size=max(7.0, size * layout.scale))


def round_length(longest: float) -> float:
    """Return the greatest of …, 0.2, 0.5, 1, 2, 5, 10, 20, 50, … that is not greater than ``longest``."""
    power = 1.0
    while power > longest:
        power /= 10
    while power * 10 <= longest:
        power *= 10
    return next(power * times for times in (5, 2, 1) if power * times <= longest)


def metres(length: float) -> str:
    """Return a length as text."""
    return f"{length:g} m"


def _title(draw: ImageDraw.ImageDraw, layout: Layout, title: str, note: str) -> None:
    base = layout.top - layout.pixels(14)
    draw.text((layout.left, base), title, INK, font(layout, TITLE_TEXT), anchor="ls")
    draw.text((layout.left + layout.columns, base), note, SOFT_INK, font(layout, TEXT), anchor="rs")


def _coordinates(draw: ImageDraw.ImageDraw, layout: Layout, window: Window) -> None:
    """Write x along the lower edge and z along the left one."""
    step = round_length(layout.columns * window.step / 4)
    tick, small = layout.pixels(5), font(layout, SMALL_TEXT)
    bottom = layout.top + layout.rows
    south = window.north - layout.rows * window.step
    for x in _multiples(step, window.west, window.west + layout.columns * window.step):
        at = layout.left + (x - window.west) / window.step
        draw.line((at, bottom, at, bottom + tick), INK, layout.pixels(1))
        draw.text((at, bottom + 2 * tick), f"{x:g}", SOFT_INK, small, anchor="mt")
    for z in _multiples(step, south, window.north):
        at = layout.top + (window.north - z) / window.step
        draw.line((layout.left - tick, at, layout.left, at), INK, layout.pixels(1))
        draw.text((layout.left - 2 * tick, at), f"{z:g}", SOFT_INK, small, anchor="rm")


def _multiples(step: float, low: float, high: float) -> list[float]:
    """Return the multiples of a step from low to high."""
    first, last = -int(-low // step), int(high // step)
    return [number * step for number in range(first, last + 1)]


def _scale_bar(draw: ImageDraw.ImageDraw, layout: Layout, window: Window) -> None:
    """Draw a bar of a round length, its first half filled."""
    length = round_length(layout.columns * window.step / 5)
    half = length / window.step / 2
    left = layout.left
    top = layout.top + layout.rows + layout.pixels(LABELS + 24)
    bottom = top + layout.pixels(7)
    draw.rectangle((left, top, left + half, bottom), INK, INK)
    draw.rectangle((left + half, top, left + 2 * half, bottom), None, INK, layout.pixels(1))
    draw.text((left, top - layout.pixels(6)), "0", INK, font(layout, SMALL_TEXT), anchor="ls")
    place = (left + 2 * half, top - layout.pixels(6))
    draw.text(place, metres(length), INK, font(layout, SMALL_TEXT), anchor="ms")


def _legend_area(layout: Layout) -> tuple[int, int]:
    """Return the left edge and the greatest width of the legend."""
    left = layout.left + layout.columns // 5 + layout.pixels(44)
    return left, layout.left + layout.columns - left - layout.pixels(40)


def _entry_width(layout: Layout, entry: Entry) -> int:
    return layout.pixels(24 + 20) + round(font(layout, TEXT).getlength(entry.text))


def _wrapped(legend: list[Entry], layout: Layout) -> list[list[Entry]]:
    """Break the legend into lines that fit."""
    room = _legend_area(layout)[1]
    lines: list[list[Entry]] = [[]]
    for entry in legend:
        used = sum(_entry_width(layout, other) for other in lines[-1])
        if lines[-1] and used + _entry_width(layout, entry) > room:
            lines.append([])
        lines[-1].append(entry)
    return lines


def _legend(draw: ImageDraw.ImageDraw, layout: Layout, lines: list[list[Entry]]) -> None:
    left = _legend_area(layout)[0]
    y = layout.top + layout.rows + layout.pixels(LABELS + 26)
    for line in lines:
        x = left
        for entry in line:
            _symbol(draw, layout, entry, x, y)
            draw.text((x + layout.pixels(24), y), entry.text, INK, font(layout, TEXT), anchor="lm")
            x += _entry_width(layout, entry)
        y += layout.pixels(26)


def _symbol(draw: ImageDraw.ImageDraw, layout: Layout, entry: Entry, x: int, y: int) -> None:
    size = layout.pixels(16)
    box = (x, y - size // 2, x + size, y - size // 2 + size)
    if entry.shape == "dot":
        inset = size // 4
        draw.ellipse((box[0] + inset, box[1] + inset, box[2] - inset, box[3] - inset), entry.color, OUTLINE)
    elif entry.shape == "round":
        draw.ellipse(box, entry.color)
    elif entry.shape == "line":
        draw.line((box[0], y, box[2], y), entry.color, layout.pixels(2))
    else:
        draw.rectangle(box, entry.color, OUTLINE if entry.shape == "house" else None)


def _north_arrow(sheet: Image.Image, layout: Layout) -> None:
    """Draw a small north arrow at the lower right, enlarged fourfold and scaled down for smooth edges."""
    size = layout.pixels(34)
    needle = Image.new("RGB", (4 * size, 4 * size), PAPER)
    draw = ImageDraw.Draw(needle)
    tip, heart, left, right, base = 2.0 * size, 3.0 * size, 1.1 * size, 2.9 * size, 3.8 * size
    draw.polygon([(tip, 0), (left, base), (tip, heart)], INK)
    draw.polygon([(tip, 0), (right, base), (tip, heart)], PAPER, INK, width=max(2, size // 10))
    x = layout.left + layout.columns - size
    y = layout.top + layout.rows + layout.pixels(LABELS + 12)
    sheet.paste(needle.resize((size, size), Image.Resampling.LANCZOS), (x, y))
    ImageDraw.Draw(sheet).text(
        (x - layout.pixels(2), y + size / 2), "N", INK, font(layout, TEXT), anchor="rm"
    )
