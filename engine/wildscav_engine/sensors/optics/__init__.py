"""What sensors share that look out of an agent's eyes: cameras, and what moves in front of them."""
