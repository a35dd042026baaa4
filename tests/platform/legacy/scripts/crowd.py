"""A script for the original's client: a battle of more agents than one of its messages can tell of."""

import sys

from inspirai_fps import ActionVariable, Game

folder, port = sys.argv[1:3]
game = Game(
    map_dir=f"{folder}/maps", engine_dir=f"{folder}/engine", engine_log_dir=f"{folder}/logs", server_port=port
)
game.set_game_mode(Game.MODE_SUP_BATTLE)
for agent in range(1, 300):
    game.add_agent(agent_name=f"agent_{agent}")
game.set_available_actions([ActionVariable.WALK_DIR])
game.init()
game.new_episode()
