"""A script for the original's client: a few actions in each mode, in one session."""

import json
import sys
from pathlib import Path
from typing import NamedTuple

from inspirai_fps import ActionVariable, Game


class Action(NamedTuple):
    walk_dir: float
    walk_speed: float
    pickup: bool
    attack: bool


class Gatherer:
    """An agent as submissions had it."""

    def __init__(self, episode_info):
        self.episode_info = episode_info

    def act(self, frame, state):
        return Action(90 * (frame // 15 % 4), 5, pickup=True, attack=False)


folder, port = Path(sys.argv[1]), int(sys.argv[2])
here, there = json.loads(sys.argv[3])
told = {}

game = Game(
    map_dir=f"{folder}/maps", engine_dir=f"{folder}/engine", engine_log_dir=f"{folder}/logs", server_port=port
)
game.set_available_actions(
    [ActionVariable.WALK_DIR, ActionVariable.WALK_SPEED, ActionVariable.PICKUP, ActionVariable.ATTACK]
)
game.set_start_location(here)
game.init()

game.set_game_mode(Game.MODE_NAVIGATION)
game.set_target_location([here[0], here[1], here[2] + 40])
game.new_episode()
for _ in range(8):
    game.make_action({0: [0, 5, False, False]})
told["north"] = game.get_state().position_z - here[2]

game.set_game_mode(Game.MODE_SUP_GATHER)
game.set_episode_timeout(3)
game.set_supply_heatmap_center([int(here[0]), int(here[2])])
game.set_supply_outdoor_richness(50)
game.new_episode()
told["boxes"] = len(game.get_state().supply_states)
agent = Gatherer({"start_location": game.get_start_location()})
while not game.is_episode_finished():
    game.make_action({0: agent.act(game.get_frame_count(), game.get_state())})
told["frames"] = game.get_frame_count()
told["gathered"] = game.get_state().num_supply

game.set_game_mode(Game.MODE_SUP_BATTLE)
game.add_agent(start_location=there)
game.new_episode()
game.make_action({0: [0, 0, False, True], 1: [0, 0, False, False]})
told["health"] = [state.health for state in game.get_state_all().values()]
game.close()

Path(sys.argv[4]).write_text(json.dumps(told))
