"""Rectangles and letters in pictures, drawn by kernels with whole numbers.

Letters are five pixels wide and seven high, times a scale. A word is a number that holds up to ten of them,
six bits each, so that kernels need no strings.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel

Picture = NDArray[np.uint8]  # (H, W, 3) red, green, blue
WIDTH, HEIGHT = 5, 7  # pixels of a letter
ADVANCE = WIDTH + 1  # pixels from one letter to the next
LETTERS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ /:.+-*="  # * is a lozenge, = a box
PICTURES = """
.###. ..#.. .###. .###. ...#. ##### ..##. ##### .###. .###. .###. ####. .###. ####. #####
#...# .##.. #...# #...# ..##. #.... .#... ....# #...# #...# #...# #...# #...# #...# #....
#..## ..#.. ....# ....# .#.#. ####. #.... ...#. #...# #...# #...# #...# #.... #...# #....
#.#.# ..#.. ..##. ..##. #..#. ....# ####. ..#.. .###. .#### ##### ####. #.... #...# ####.
##..# ..#.. .#... ....# ##### ....# #...# ..#.. #...# ....# #...# #...# #.... #...# #....
#...# ..#.. #.... #...# ...#. #...# #...# ..#.. #...# ...#. #...# #...# #...# #...# #....
.###. .###. ##### .###. ...#. .###. .###. ..#.. .###. .##.. #...# ####. .###. ####. #####

##### .###. #...# .###. ..### #...# #.... #...# #...# .###. ####. .###. ####. .#### #####
#.... #...# #...# ..#.. ...#. #..#. #.... ##.## ##..# #...# #...# #...# #...# #.... ..#..
#.... #.... #...# ..#.. ...#. #.#.. #.... #.#.# #.#.# #...# #...# #...# #...# #.... ..#..
####. #.### ##### ..#.. ...#. ##... #.... #.#.# #.#.# #...# ####. #...# ####. .###. ..#..
#.... #...# #...# ..#.. ...#. #.#.. #.... #...# #..## #...# #.... #.#.# #.#.. ....# ..#..
#.... #...# #...# ..#.. #..#. #..#. #.... #...# #...# #...# #.... #..#. #..#. ....# ..#..
#.... .#### #...# .###. .##.. #...# ##### #...# #...# .###. #.... .##.# #...# ####. ..#..

#...# #...# #...# #...# #...# ##### ..... ....# ..... ..... ..... ..... ..... .....
#...# #...# #...# #...# #...# ....# ..... ....# ..#.. ..... ..#.. ..... ..#.. #####
#...# #...# #...# .#.#. .#.#. ...#. ..... ...#. ..#.. ..... ..#.. ..... .###. #...#
#...# #...# #.#.# ..#.. ..#.. ..#.. ..... ..#.. ..... ..... ##### ##### ##### #####
#...# #...# #.#.# .#.#. ..#.. .#... ..... .#... ..#.. ..... ..#.. ..... .###. #...#
#...# .#.#. ##.## #...# ..#.. #.... ..... #.... ..#.. .##.. ..#.. ..... ..#.. #...#
.###. ..#.. #...# #...# ..#.. ##### ..... #.... ..... .##.. ..... ..... ..... #####
"""


def _bits() -> NDArray[np.uint8]:
    """Return (letters, 7) the rows of all letters, the left pixel in the highest of five bits."""
    blocks = [[line.split() for line in block.splitlines()] for block in PICTURES.strip().split("\n\n")]
    letters = [letter for block in blocks for letter in zip(*block, strict=True)]
    binary = str.maketrans(".#", "01")
    return np.array([[int(row.translate(binary), 2) for row in letter] for letter in letters], np.uint8)


BITS = _bits()


def word(text: str) -> int:
    """Return a text of at most ten letters as a number."""
    return sum((1 + LETTERS.index(letter)) << (6 * place) for place, letter in enumerate(text))


@kernel
def letters_of(text: int) -> int:
    """Return the number of letters in a word."""
    count = 0
    while text > 0:
        text >>= 6
        count += 1
    return count


@kernel
def digits_of(number: int) -> int:
    """Return the number of digits of a number that is not negative."""
    count = 1
    while number >= 10:
        number //= 10
        count += 1
    return count


@kernel
def fill(picture: Picture, left: int, top: int, width: int, height: int, color: int) -> None:
    """Fill the part of a rectangle that is in the picture with a colour, 0xRRGGBB."""
    for row in range(max(0, top), min(picture.shape[0], top + height)):
        for column in range(max(0, left), min(picture.shape[1], left + width)):
            picture[row, column, 0] = color >> 16
            picture[row, column, 1] = (color >> 8) & 255
            picture[row, column, 2] = color & 255


@kernel
def shade(picture: Picture, left: int, top: int, width: int, height: int) -> None:
    """Darken a rectangle to a quarter, so that what stands on it can be read."""
    for row in range(max(0, top), min(picture.shape[0], top + height)):
        for column in range(max(0, left), min(picture.shape[1], left + width)):
            for channel in range(3):
                picture[row, column, channel] >>= 2


@kernel
def write_letter(picture: Picture, left: int, top: int, letter: int, scale: int, color: int) -> int:
    """Write a letter by its place in ``LETTERS``, and return where the next one begins."""
    for row in range(HEIGHT):
        for column in range(WIDTH):
            if (BITS[letter, row] >> (WIDTH - 1 - column)) & 1:
                fill(picture, left + column * scale, top + row * scale, scale, scale, color)
    return left + ADVANCE * scale


@kernel
def write_word(picture: Picture, left: int, top: int, text: int, scale: int, color: int) -> int:
    """Write a word, and return where the next letter begins."""
    while text > 0:
        left = write_letter(picture, left, top, (text & 63) - 1, scale, color)
        text >>= 6
    return left


@kernel
def write_number(picture: Picture, left: int, top: int, number: int, scale: int, color: int) -> int:
    """Write a number that is not negative, and return where the next letter begins."""
    end = left + digits_of(number) * ADVANCE * scale
    place = end
    for _ in range(digits_of(number)):
        place -= ADVANCE * scale
        write_letter(picture, place, top, number % 10, scale, color)
        number //= 10
    return end
