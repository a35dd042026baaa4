"""The tables of all commands. They keep all columns, however narrow the terminal is."""

from collections.abc import Iterator
from typing import Any

from rich import box
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.table import Column, Table
from rich.text import Text

COMFORTABLE, NARROWEST = 24, 12  # characters for a column of text that may be wrapped: wanted, and the least
UNBOUNDED = 10_000  # characters


class FittingTable(Table):
    """A table in our style. Where columns do not fit side by side, each row becomes a block of lines."""

    def __init__(self, title: str | None = None) -> None:
        super().__init__(
            title=title,
            title_justify="left",
            title_style="bold",
            box=box.SIMPLE_HEAD,
            padding=(0, 1, 0, 0),
            show_edge=False,
        )

    def add_column(self, *arguments: Any, **settings: Any) -> None:
        """Add a column. Words that are too long are broken, not truncated, unless ``settings`` differ."""
        super().add_column(*arguments, **{"overflow": "fold", **settings})

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Yield the table in the widest form that fits."""
        padding = self._spacing(console, options)
        if padding is None:
            yield from self._stacked()
        else:
            self.padding = (0, padding, 0, 0)
            yield from super().__rich_console__(console, options)

    def fits(self, console: Console) -> bool:
        """Return whether the columns fit side by side."""
        return self._spacing(console, console.options) is not None

    def _spacing(self, console: Console, options: ConsoleOptions) -> int | None:
        """Return the widest space after columns with which they fit side by side; None if they do not."""
        wide = options.update(max_width=UNBOUNDED)
        # First columns move closer together, then text is wrapped, and last rows become blocks.
        for padding, text in ((1, COMFORTABLE), (0, COMFORTABLE), (0, NARROWEST)):
            needed = sum(_needs(console, wide, column, text) for column in self.columns)
            # In addition to the padding, there is one space between two columns.
            if needed + len(self.columns) * (padding + 1) - 1 <= options.max_width:
                return padding
        return None

    def _stacked(self) -> Iterator[RenderableType]:
        """Yield each row as a block with a line for each column: its heading and the cell."""
        headings = [" ".join(str(column.header).replace("-\n", "-").split()) for column in self.columns]
        cells = zip(*(column.cells for column in self.columns), strict=True)
        if self.title:
            yield Text(str(self.title), "bold")
        for number, row in enumerate(cells):
            if number:
                yield Text()
            block = Table.grid(padding=(0, 2))
            block.add_column(style="dim")
            block.add_column(overflow="fold")
            for heading, cell in zip(headings, row, strict=True):
                if str(cell):
                    block.add_row(heading, cell)
            yield block


def _needs(console: Console, options: ConsoleOptions, column: Column, text: int) -> int:
    """Return the width that a column needs if text that may be wrapped gets ``text`` characters."""
    sizes = [Measurement.get(console, options, cell) for cell in (column.header, *column.cells)]
    if column.no_wrap:
        return max(size.maximum for size in sizes)
    return max(column.min_width or 0, min(text, max(size.maximum for size in sizes)))
