"""A script for the original's client: gathering, then a battle of ten, on two maps, with depth maps."""

import json
import sys
from pathlib import Path

from inspirai_fps import ActionVariable, Game
from inspirai_fps.utils import get_distance, get_picth_yaw, get_position

folder, port = Path(sys.argv[1]), int(sys.argv[2])
here, there = json.loads(sys.argv[3]), json.loads(sys.argv[4])
told = {}

game = Game(
    map_dir=f"{folder}/maps", engine_dir=f"{folder}/engine", engine_log_dir=f"{folder}/logs", server_port=port
)
game.set_available_actions(
    [
        *(ActionVariable.WALK_DIR, ActionVariable.WALK_SPEED),
        *(ActionVariable.PICKUP, ActionVariable.ATTACK, ActionVariable.RELOAD),
    ]
)
game.init()

# Gathering: to the nearest supply, and on, with the depth map.
game.set_game_mode(Game.MODE_SUP_GATHER)
game.set_random_seed(3)
game.set_episode_timeout(6)
game.set_start_location(here)
game.set_supply_heatmap_center([round(here[0]), round(here[2])])
game.set_supply_heatmap_radius(20)
game.set_supply_indoor_richness(50)
game.set_supply_outdoor_richness(50)
game.set_supply_indoor_quantity_range(10, 50)
game.set_supply_outdoor_quantity_range(1, 5)
game.set_supply_spacing(3)
game.turn_on_depth_map()
game.new_episode()
state = game.get_state()
told["boxes"] = len(state.supply_states)
while not game.is_episode_finished():
    state = game.get_state()
    places = [(s.position_x, s.position_y, s.position_z) for s in state.supply_states]
    nearest = min(places, key=lambda place: get_distance(get_position(state), place))
    way = [goal - own for goal, own in zip(nearest, get_position(state), strict=True)]
    game.make_action({0: [get_picth_yaw(*way)[1] % 360, 5, True, False, False]})
told["gathered"] = game.get_state().num_supply
told["depth"] = list(state.depth_map.shape)
told["farthest"] = float(state.depth_map.max())
told["frames"] = game.get_frame_count()

# Battle: on another map, the first of ten shoots the second.
game.turn_off_depth_map()
game.set_map_id(2)
game.set_game_mode(Game.MODE_SUP_BATTLE)
game.set_episode_timeout(15)
locations = game.outdoor_locations
game.set_start_location(there[0])
game.add_agent(start_location=there[1], health=60)
for number in range(2, 10):
    game.add_agent(start_location=locations[number * 50])
game.new_episode()
shots = []
for _ in range(40):
    game.make_action({0: [0, 0, False, True, False]})
    shots.append([(s.health, s.is_waiting_respawn, s.hit_by_enemy) for s in game.get_state_all().values()][1])
told["agents"] = len(game.get_state_all())
told["shots"] = shots
told["ammo"] = game.get_state(0).weapon_ammo
while not game.is_episode_finished():
    game.make_action({agent: [36 * agent, 3, True, False, True] for agent in range(10)})
last = game.get_state(1)
told["last"] = [last.health, last.is_invincible]
game.close()

Path(sys.argv[5]).write_text(json.dumps(told))
