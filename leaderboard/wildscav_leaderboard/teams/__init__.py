"""Teams: who competes together."""
