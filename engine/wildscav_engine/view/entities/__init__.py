"""What a replay shows: agents, supply boxes, the ground, heat maps, the safe zone."""
