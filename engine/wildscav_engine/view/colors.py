"""The colours of what a replay shows beside the world itself, as red, green, blue 0-255."""

from wildscav_engine.palette import SUPPLY_BOX

EARTH, DEEP_EARTH = (128, 98, 70), (84, 64, 48)

OUTDOOR_BOX, INDOOR_BOX, DROPPED_BOX = SUPPLY_BOX, (30, 110, 255), (120, 80, 235)
TARGET = (255, 60, 160)
ZONE, NEXT_ZONE = (80, 160, 255), (255, 255, 255)
START = (250, 250, 250)
SHOT, HIT = (255, 224, 90), (255, 50, 40)
PICK_UP, DEATH, RESPAWN, GOAL = (70, 190, 255), (255, 70, 60), (190, 190, 190), (255, 110, 190)
START_END = (255, 255, 255)
DEAD = (150, 150, 155)
