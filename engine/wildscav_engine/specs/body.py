"""The body of an agent and what it can do: constants of the engine.

An organizer cannot change them, because which places of a map can be reached depends on them. The radius,
the height, the eye and the speed are the original game's; the rest it never published.
"""

BODY_RADIUS = 0.45  # m
BODY_HEIGHT = 1.78  # m
EYE_HEIGHT = 1.5  # m above the soles
STEP_HEIGHT = 0.5  # m, what is walked onto without a jump, up and down
SLOPE_LIMIT = 45.0  # degrees, the steepest ground that is walked up or stood on
TAN_SLOPE_LIMIT = 1.0
COS_SLOPE_LIMIT = 0.7071067811865476
SLIDE_SPEED = 5.0  # m/s, downhill on steeper ground
GRAVITY = 9.81  # m/s²
JUMP_SPEED = 5.0  # m/s upwards: 1.27 m high, 1.02 s long on level ground; none in water or on steep ground
FALL_SPEED_LIMIT = 50.0  # m/s
EDGE_MARGIN = 0.5  # m between the body's axis and the edge of the map
