"""The entities of a replay: agents, supply boxes, the ground, heat maps, the safe zone."""
