"""The renderer of environments: images, depth maps, a window, or a live view in Rerun."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.envs.rendering.markers import mark_agents
from wildscav_engine.envs.rendering.window import Window
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.sensors import ColorCamera, DepthCamera
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.video.cameras import behind
from wildscav_engine.view.video.moments import Moment

if TYPE_CHECKING:
    from wildscav_engine.envs.arena import Arena
    from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
    from wildscav_engine.view.live import LiveView

TOP_FIELD_OF_VIEW = 40.0  # degrees, of the camera above the map
PICTURE, WINDOW = (320, 180), (960, 540)  # pixels across and down, unless the options have others
CLEARANCE = 60.0  # m, minimum height of that camera above the ground


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
        moment = Moment(
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
