"""Constants of the engine: the size of an agent's body and the limits of its motion.

Organizers cannot change them, because they determine which places of a map can be reached. The radius, the
height, the eye height and the walking speed (see ``actions.py``) are those of the original game, which never
published the others.
"""

BODY_RADIUS = 0.45  # m
BODY_HEIGHT = 1.78  # m
EYE_HEIGHT = 1.5  # m above the soles
STEP_HEIGHT = 0.5  # m, up or down, that can be walked without a jump
SLOPE_LIMIT = 45.0  # degrees, the steepest ground that can be climbed or stood on
TAN_SLOPE_LIMIT = 1.0
COS_SLOPE_LIMIT = 0.7071067811865476
SLIDE_SPEED = 5.0  # m/s, downhill on steeper ground
GRAVITY = 9.81  # m/s²
JUMP_SPEED = 5.0  # m/s upwards: 1.27 m high, 1.02 s long on level ground; none in water or on steep ground
FALL_SPEED_LIMIT = 50.0  # m/s
EDGE_MARGIN = 0.5  # m between the body's axis and the edge of the map
