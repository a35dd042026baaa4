"""Matches in the browser, to watch in 3D and to play.

A match that is watched is drawn by the browser (``viewer/``), from two files (``scene/``). A person who plays
has a page that draws what their seat may know (``sight.py``), and sends keys and mouse back. The match is
hosted by the same server as any other: a person joins through the SDK like any agent.
"""
