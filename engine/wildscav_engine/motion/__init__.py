"""The motion of a body through the world: walking, jumping, falling and collisions."""
