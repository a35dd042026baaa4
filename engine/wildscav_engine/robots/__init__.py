"""Built-in opponents that play inside the engine."""
