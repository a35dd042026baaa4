"""The output folder of an evaluation: its identity, its files and their formats."""
