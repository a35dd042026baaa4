"""A script for the original's client: two episodes of navigation, the way its README teaches it."""

import json
import sys
from pathlib import Path

from inspirai_fps import ActionVariable, Game

folder, port, start, target = (
    Path(sys.argv[1]),
    int(sys.argv[2]),
    json.loads(sys.argv[3]),
    json.loads(sys.argv[4]),
)

game = Game(
    map_dir=f"{folder}/maps",
    engine_dir=f"{folder}/engine",
    engine_log_dir=f"{folder}/logs",
    server_port=port,
)
game.set_game_mode(Game.MODE_NAVIGATION)
game.set_random_seed(5)
game.set_episode_timeout(4)
game.set_start_location(start)
game.set_target_location(target)
game.set_available_actions(
    [ActionVariable.WALK_DIR, ActionVariable.WALK_SPEED, ActionVariable.TURN_LR_DELTA, ActionVariable.JUMP]
)
game.turn_on_record()
game.init()

episodes = []
for speed in (5, 10):
    game.set_game_replay_suffix(f"_speed_{speed}")
    game.new_episode()
    states = [game.get_state()]
    while not game.is_episode_finished():
        game.make_action({0: [0, speed, 1, False]})
        states.append(game.get_state())
    episodes.append(
        [
            {"frame": s.time_step, "x": s.position_x, "y": s.position_y, "z": s.position_z, "yaw": s.yaw}
            for s in states
        ]
    )
game.close()

Path(sys.argv[5]).write_text(json.dumps(episodes))
