"""A person in a seat of a match: a page with pictures from the seat's eyes, which sends keys and mouse back.

The match is hosted by the same server as any other. A person joins through the SDK like any agent, and only
the pictures are made here, from what the seat sees.
"""
