"""The renderer of environments: images, depth maps, a window, or a live view in Rerun."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.sensors import ColorCamera, DepthCamera
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of
from wildscav_engine.simulation.state import Agents
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.display import check_display
from wildscav_engine.view.video.cameras import behind
from wildscav_engine.view.video.moments import InterpolatedState

if TYPE_CHECKING:
    from wildscav_engine.envs.arena import Arena
    from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
    from wildscav_engine.view.live import LiveView

TOP_FIELD_OF_VIEW = 40.0  # degrees, of the camera above the map
PICTURE, WINDOW = (320, 180), (960, 540)  # pixels across and down, unless the options have others
CLEARANCE = 60.0  # m, minimum height of that camera above the ground
SIZE = 0.022  # of the image's longer side, from an arrowhead's center to its tip
MIN_SIZE = 5.0  # pixels
RIM = 1.6  # pixels, width of a dark rim that makes the marker visible on any ground
# Corners relative to the center, to the right and ahead, in units of the distance to the tip.
ARROWHEAD = ((0.0, 1.0), (0.75, -0.8), (0.0, -0.4), (-0.75, -0.8))
DARK = (20, 20, 20)
INSTALL = "render_mode=\"human\" needs pygame: pip install 'wildscav[window]'"


def _tangent(angle: float) -> float:
    return float(sine(angle) / cosine(angle))


class Renderer:
    """The renderer of an arena in the render mode of its options."""

    def __init__(self, config: EnvConfig) -> None:
        """Create a renderer with the options of an environment."""
        self._mode, self._view = config.render_mode, config.render_view
        width, height = config.render_size or (WINDOW if self._mode == "human" else PICTURE)
        self._color = ColorCamera(width, height)
        self._above = ColorCamera(width, height, far=2000.0, field_of_view=TOP_FIELD_OF_VIEW)
        self._depth = DepthCamera(width, height)
        self._live: LiveView | None = None
        self._window = Window(FRAMES_PER_SECOND / config.frames_per_action)

    def begin(self, arena: "Arena") -> None:
        """Start to show a new match in the window or the live view, which opens with the first match."""
        if self._mode == "rerun":
            from wildscav_engine.view.live import LiveView

            if self._live is None:
                self._live = LiveView()
            self._live.begin(arena.view(0))
        self.show(arena)

    def show(self, arena: "Arena") -> None:
        """Update the window or the live view; nothing in other modes."""
        if self._live is not None:
            self._live.show(arena.view(0))
        if self._mode == "human" and not self._window.is_closed:
            view = arena.view(0)
            time = f"{view.frame / FRAMES_PER_SECOND:.0f} of {view.spec.time_limit:.0f} s"
            self._window.show(self._picture(view, 0), f"{view.track.title}: {time}")

    def render(self, arena: "Arena", match: int = 0, seat: int = 0) -> NDArray[Any] | None:
        """Return an image of what a seat sees, of the seat from behind, or of the whole match from above."""
        if self._mode == "rgb_array":
            return self._picture(arena.view(match), seat)
        if self._mode == "depth_array":
            return np.asarray(self._depth.read(arena.view(match), [seat])[0])
        return None

    def _picture(self, view: "MatchInBatch", seat: int) -> NDArray[np.uint8]:
        if self._view == "top":
            return self._from_above(view)
        if self._view == "behind":
            return self._from_behind(view, seat)
        return np.asarray(self._color.read(view, [seat])[0])

    def _from_behind(self, view: "MatchInBatch", seat: int) -> NDArray[np.uint8]:
        """Return an image of a seat and of what lies before it."""
        agents = view.state.agents
        moment = InterpolatedState(
            view.frame, 0, agents.position[0], agents.yaw[0], agents.pitch[0], agents.health[0] > 0
        )
        camera = behind(view.game_map.world, moment, seat)
        pictures = self._color.render(
            view.game_map,
            camera.eye[None],
            [camera.yaw],
            [camera.pitch],
            moving=dynamic_objects_of(view),
            viewers=None if camera.hidden is None else [camera.hidden],
        )
        return np.asarray(pictures[0])

    def _from_above(self, view: "MatchInBatch") -> NDArray[np.uint8]:
        """Return an image of the whole map from above, with north at the top."""
        heights = view.game_map.world.heights
        half = view.game_map.config.size / 2
        ratio = self._above.height / self._above.width
        # High enough that even the highest edge of the map is in view.
        tangent = _tangent(TOP_FIELD_OF_VIEW / 2) * min(1.0, ratio)
        eye = np.array([[0.0, float(heights.max()) + max(CLEARANCE, half / tangent), 0.0]])
        moving = dynamic_objects_of(view)
        picture = np.array(self._above.render(view.game_map, eye, [0.0], [90.0], moving=moving)[0])
        mark_agents(
            picture, view.state.agents, float(eye[0, 1]), tangent_of_half=_tangent(TOP_FIELD_OF_VIEW / 2)
        )
        return picture

    def close(self) -> None:
        """Close the window and the recording of the live view, if they are open."""
        self._window.close()
        if self._live is not None:
            self._live.close()
            self._live = None


def mark_agents(picture: NDArray[np.uint8], agents: Agents, height: float, *, tangent_of_half: float) -> None:
    """Mark the living agents of one match in a picture (height, width, 3), in place.

    The camera is above the middle of the map at a height in m, with north at the top. ``tangent_of_half`` is
    that of half its horizontal angle of view.
    """
    rows, columns = picture.shape[:2]
    size = max(MIN_SIZE, SIZE * max(rows, columns))
    for seat in np.flatnonzero(agents.health[0] > 0).tolist():
        x, y, z = agents.position[0, seat].tolist()
        scale = columns / 2 / (tangent_of_half * (height - y))  # pixels per metre
        center = (columns / 2 + x * scale, rows / 2 - z * scale)
        yaw = float(agents.yaw[0, seat])
        _fill(picture, _corners(center, yaw, size + RIM), DARK)
        _fill(picture, _corners(center, yaw, size), of_seat(int(agents.team[0, seat])))


def _corners(center: tuple[float, float], yaw: float, size: float) -> NDArray[np.float64]:
    """Return (4, 2) the corners of an arrowhead, in pixels to the right and down."""
    ahead = np.array([sine(yaw), -cosine(yaw)])
    right = np.array([-ahead[1], ahead[0]])
    return np.array(
        [np.array(center) + size * (across * right + along * ahead) for across, along in ARROWHEAD]
    )


def _fill(picture: NDArray[np.uint8], corners: NDArray[np.float64], color: tuple[int, int, int]) -> None:
    """Fill the two triangles on either side of an arrowhead's axis, clipped to the image."""
    rows, columns = picture.shape[:2]
    left, top = np.clip(np.floor(corners.min(axis=0)).astype(int), 0, (columns, rows))
    right, bottom = np.clip(np.ceil(corners.max(axis=0)).astype(int) + 1, 0, (columns, rows))
    across, down = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
    tip, one, notch, other = corners
    inside = _in_triangle(across, down, tip, one, notch) | _in_triangle(across, down, tip, notch, other)
    picture[top:bottom, left:right][inside] = color


def _in_triangle(
    across: NDArray[np.float64], down: NDArray[np.float64], *corners: NDArray[np.float64]
) -> NDArray[np.bool_]:
    sides = []
    for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
        edge = end - start
        sides.append(edge[0] * (down - start[1]) - edge[1] * (across - start[0]) >= 0.0)
    inside: NDArray[np.bool_] = np.equal(sides[0], sides[1]) & np.equal(sides[1], sides[2])  # all on one side
    return inside


class Window:
    """A window that opens with its first picture, and stays closed once its user closes it."""

    def __init__(self, pictures_per_second: float) -> None:
        """Create a window without opening it."""
        self._rate = pictures_per_second
        self._screen: Any = None
        self._clock: Any = None
        self.is_closed = False  # by its user

    def show(self, picture: NDArray[np.uint8], title: str) -> None:
        """Show a picture (height, width, 3), and wait until the next one is due."""
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
