"""Matches of people against submissions, on the season's own site.

Each person's table is a process of its own (``host.py``), in which the submission runs in the season's
sandbox. The web server starts it, ends it (``tables.py``), and passes requests on to it (``passing.py``).
"""
