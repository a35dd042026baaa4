"""Agents of every kind, for processes that the tests start."""

import asyncio
import math
import os
import sys
import time

from wildscav import Action, Agent, MatchInfo, Observation


class Walker(Agent):
    """Walks in circles and does everything else as well."""

    def act(self, observation: Observation) -> Action:
        return Action(
            walk_direction=observation.step * 7.0,
            walk_speed=5.0,
            turn=2.0,
            look=0.5,
            jump=observation.step % 10 == 0,
            pick_up=True,
            shoot=observation.step % 5 == 0,
            reload=observation.clip == 0,
        )


class Killed(Walker):
    """Its process dies in the middle of the match, without a word."""

    def act(self, observation: Observation) -> Action:
        if observation.step == 5:
            os.kill(os.getpid(), 9)
        return super().act(observation)


class Sleepy(Walker):
    """Falls asleep once, for longer than its time bank."""

    def act(self, observation: Observation) -> Action:
        if observation.step == 3:
            time.sleep(0.5)
        return super().act(observation)


class ThinksInLoops(Walker):
    """Runs event loops of its own, as for asking a model over a network: new ones, and one that stays."""

    def reset(self, match: MatchInfo) -> None:
        self.own = asyncio.new_event_loop()
        self.own.run_until_complete(asyncio.sleep(0.001))

    def act(self, observation: Observation) -> Action:
        self.own.run_until_complete(self.think(observation))
        return asyncio.run(self.think(observation))

    async def think(self, observation: Observation) -> Action:
        await asyncio.gather(asyncio.sleep(0.0001), asyncio.to_thread(math.sqrt, 2.0))
        return super().act(observation)


class ReturnsThree(Agent):
    """Answers with something that is no action."""

    def act(self, observation: Observation) -> Action:
        return 3  # type: ignore[return-value]


class Raises(Agent):
    """Fails in its own code."""

    def act(self, observation: Observation) -> Action:
        raise RuntimeError("my own fault")


class Exits(Agent):
    """Ends its process with a code that means that all is well."""

    def reset(self, match: MatchInfo) -> None:
        sys.exit(0)


class SeesDepth(Agent):
    """Fails unless its depth map is as asked for."""

    def act(self, observation: Observation) -> Action:
        if observation.depth.shape != (5, 8) or not (observation.depth > 0).all():
            raise RuntimeError(f"depth is {observation.depth!r}")
        return Action()


class NoAgent:
    """Has not one method of an agent."""


class TellsHowItRuns(Walker):
    """Says under which of the system's policies it plays."""

    def act(self, observation: Observation) -> Action:
        sys.stderr.write(f"{os.sched_getscheduler(0)}\n")
        return super().act(observation)
