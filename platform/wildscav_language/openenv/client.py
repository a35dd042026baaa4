"""The client of an environment of OpenEnv that plays a seat of Wildscav."""

from typing import Any

from openenv.core import EnvClient
from openenv.core.client_types import StepResult

from wildscav_language.openenv.models import WildscavAction, WildscavObservation, WildscavState


class WildscavEnv(EnvClient[WildscavAction, WildscavObservation, WildscavState]):
    """Plays at a server of ``wildscav_language.openenv.app``; ``sync()`` gives one without ``await``."""

    def _step_payload(self, action: WildscavAction) -> dict[str, Any]:
        payload: dict[str, Any] = action.model_dump()
        return payload

    def _parse_result(self, payload: dict[str, Any]) -> StepResult[WildscavObservation]:
        reward, done = payload["reward"], payload["done"]
        observation = WildscavObservation(**payload["observation"], reward=reward, done=done)
        return StepResult(observation, reward, done, metadata=observation.metadata)

    def _parse_state(self, payload: dict[str, Any]) -> WildscavState:
        return WildscavState(**payload)
