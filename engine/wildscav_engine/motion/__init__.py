"""How a body moves through the world: walking, jumping, falling, and what it collides with."""
