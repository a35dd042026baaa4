"""The columns of an array table; see ``array_tables.py``."""

ADDRESS, ITEM, ROWS, LENGTH = 0, 1, 2, 3  # of the first byte; bytes per item; the first two axes

AXES = 4  # the largest number of axes of an array
COLUMNS = 2 + AXES
