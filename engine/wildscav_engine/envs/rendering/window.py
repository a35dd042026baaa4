"""The window of ``render_mode="human"``, by pygame as in Gymnasium's own environments."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.view.display import check_display

INSTALL = "render_mode=\"human\" needs pygame: pip install 'wildscav[window]'"


class Window:
    """A window that opens with its first picture, and stays closed once its user closes it."""

    def __init__(self, pictures_per_second: float) -> None:
        """Create a window without opening it."""
        self._rate = pictures_per_second
        self._screen: Any = None
        self._clock: Any = None
        self.is_closed = False  # by its user

    def show(self, picture: NDArray[np.uint8], title: str) -> None:
        """Show a picture, and wait until the next one is due.

        Args:
            picture: (height, width, 3) red, green, blue.
            title: What stands above it.

        Raises:
            NoDisplayError: There is no display.
            gymnasium.error.DependencyNotInstalled: pygame is not installed.
        """
        if self.is_closed:
            return
        pygame = _pygame()
        height, width = picture.shape[:2]
        if self._screen is None:
            check_display("human", others=("SDL_VIDEODRIVER",))
            pygame.display.init()
            self._screen = pygame.display.set_mode((width, height))
            self._clock = pygame.time.Clock()
        pygame.display.set_caption(title)
        pygame.surfarray.blit_array(self._screen, picture.swapaxes(0, 1))
        pygame.display.flip()
        self._clock.tick(self._rate)
        if any(event.type == pygame.QUIT for event in pygame.event.get()):
            self.close()
            self.is_closed = True

    def close(self) -> None:
        """Close the window, if it is open."""
        if self._screen is not None:
            _pygame().display.quit()
            self._screen = None


def _pygame() -> Any:
    try:
        import pygame
    except ImportError as error:
        from gymnasium.error import DependencyNotInstalled

        raise DependencyNotInstalled(INSTALL) from error
    return pygame
