"""The match server: many matches at once in one event loop, with one stream per seat."""
