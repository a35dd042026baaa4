"""How the rays of an image find what they meet: see ``rendering.trace``."""
