"""A script for the original's client: plays an episode of each mode and prints actions a second."""

import sys
import time

from inspirai_fps import ActionVariable, Game

folder, engine, port = sys.argv[1], sys.argv[2], int(sys.argv[3])
# Of each mode: how many agents play, and how many actions.
modes = [tuple(map(int, mode.split(","))) for mode in sys.argv[4:]]

game = Game(map_dir=f"{folder}/maps", engine_dir=engine, engine_log_dir=f"{folder}/logs", server_port=port)
game.set_random_seed(1)
game.set_start_location(game.outdoor_locations[100])
game.set_target_location(game.outdoor_locations[-1])
# Supplies as the competition had them.
game.set_supply_heatmap_radius(30)
game.set_supply_outdoor_richness(20)
game.set_supply_indoor_richness(70)
game.set_supply_spacing(10)
game.set_available_actions(
    [
        *(ActionVariable.WALK_DIR, ActionVariable.WALK_SPEED, ActionVariable.TURN_LR_DELTA),
        *(ActionVariable.PICKUP, ActionVariable.ATTACK),
    ]
)
game.init()
for mode, agents, steps in modes:
    game.set_game_mode(mode)
    game.set_episode_timeout(steps // 10)
    for agent in range(len(game.GM.agent_setups), agents):
        game.add_agent(agent_name=f"agent_{agent}", start_location=game.outdoor_locations[100 + 40 * agent])
    game.new_episode()
    taken = 0
    began = time.perf_counter()
    while not game.is_episode_finished():
        states = game.get_state_all()
        game.make_action({agent: [(taken * 7 + 36 * agent) % 360, 5, 1, True, False] for agent in states})
        taken += 1
    sys.stdout.write(f"\nrate {taken / (time.perf_counter() - began)}\n")
game.close()
