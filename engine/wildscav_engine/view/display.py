"""Whether there is a display to open a window on."""

import os
import sys
from collections.abc import Mapping


class NoDisplayError(RuntimeError):
    """There is no display to open a window on."""


def check_display(mode: str, others: tuple[str, ...] = ()) -> None:
    """Refuse to open a window where there is no display.

    Args:
        mode: The render mode that opens the window.
        others: Variables of the environment that name something else to draw on.

    Raises:
        NoDisplayError: There is no display.
    """
    settings: Mapping[str, str] = os.environ
    known = ("DISPLAY", "WAYLAND_DISPLAY", *others)
    if sys.platform == "linux" and not any(settings.get(name) for name in known):
        raise NoDisplayError(
            f'render_mode="{mode}" opens a window, and there is no display (neither DISPLAY nor '
            'WAYLAND_DISPLAY is set): use render_mode="rgb_array", or gymnasium.wrappers.RecordVideo'
        )
