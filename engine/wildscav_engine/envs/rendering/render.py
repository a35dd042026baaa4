"""The renderer of environments: images, depth maps, or a live view in Rerun."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.envs.rendering.markers import mark_agents
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.sensors import ColorCamera, DepthCamera
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of

if TYPE_CHECKING:
    from wildscav_engine.envs.arena import Arena
    from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
    from wildscav_engine.view.live import LiveView

TOP_FIELD_OF_VIEW = 40.0  # degrees, of the camera above the map
CLEARANCE = 60.0  # m, minimum height of that camera above the ground


def _tangent(angle: float) -> float:
    return float(sine(angle) / cosine(angle))


class Renderer:
    """The renderer of an arena in the render mode of its options."""

    def __init__(self, config: EnvConfig) -> None:
        """Create a renderer with the options of an environment."""
        self._mode, self._view = config.render_mode, config.render_view
        width, height = config.render_size
        self._color = ColorCamera(width, height)
        self._above = ColorCamera(width, height, far=2000.0, field_of_view=TOP_FIELD_OF_VIEW)
        self._depth = DepthCamera(width, height)
        self._live: LiveView | None = None

    def begin(self, arena: "Arena") -> None:
        """Start to show a new match in the live view, which opens with the first match."""
        if self._mode != "human":
            return
        from wildscav_engine.view.live import LiveView

        if self._live is None:
            self._live = LiveView()
        self._live.begin(arena.view(0))
        self.show(arena)

    def show(self, arena: "Arena") -> None:
        """Update the live view."""
        if self._live is not None:
            self._live.show(arena.view(0))

    def render(self, arena: "Arena", match: int = 0, seat: int = 0) -> NDArray[Any] | None:
        """Return an image of what a seat sees, or of the whole match from above."""
        view = arena.view(match)
        if self._mode == "rgb_array" and self._view == "top":
            return self._from_above(view)
        if self._mode not in {"rgb_array", "depth_array"}:
            return None
        camera = self._color if self._mode == "rgb_array" else self._depth
        return np.asarray(camera.read(view, [seat])[0])

    def _from_above(self, view: "MatchInBatch") -> NDArray[Any]:
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
        """Close the recording of the live view, if there is one."""
        if self._live is not None:
            self._live.close()
            self._live = None
