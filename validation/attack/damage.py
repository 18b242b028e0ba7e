"""Damaged copies of files, from a seed."""

from __future__ import annotations

import random
import re

# What numbers of a text are replaced by.
NUMBERS = (b"1e400", b"-1e400", b"NaN", b"1e308", b"-0", b"0", b"4294967296", b"-1", b"1e-320", b"99999999999999999999", b"null", b'""')
WORDS = (b"\xff\xfe", b"\x00", b"{", b"[" * 2000, b'"\\ud800"', b"=cmd|' /C calc'!A0", b"\xe2\x80\xae", b"\x1b[2J\n", b"\\u001b[2J\\n\\u202e", b"A" * 100_000, b",,,,")


def damaged(data: bytes, dice: random.Random) -> bytes:
    """A copy with one to four faults: cut, overwritten, bits turned, parts repeated or moved, numbers replaced."""
    copy = bytearray(data)
    for _ in range(dice.randint(1, 4)):
        if not copy:
            break
        # Half of the faults lie where headers are.
        place = dice.randrange(len(copy) if dice.random() < 0.5 else min(len(copy), 2000))
        kind = dice.randrange(8)
        if kind == 0:
            del copy[place:]
        elif kind == 1:
            copy[place] = dice.randrange(256)
        elif kind == 2:
            copy[place] ^= 1 << dice.randrange(8)
        elif kind == 3:
            end = min(len(copy), place + dice.randint(1, 4000))
            copy[place:place] = copy[place:end]
        elif kind == 4:
            del copy[place : place + dice.randint(1, 400)]
        elif kind == 5:
            copy[place:place] = dice.choice(WORDS)
        elif kind == 6 and len(copy) >= 8:
            place = dice.randrange(len(copy) - 7)
            copy[place : place + 4] = dice.choice((b"\xff\xff\xff\xff", b"\x00\x00\x00\x00", b"    ", b"\xff\xff\xff\x7f"))
        else:
            copy = replaced_number(copy, dice)
    return bytes(copy)


def replaced_number(text: bytearray, dice: random.Random) -> bytearray:
    """Another number in the place of one near a random place."""
    place = dice.randrange(len(text))
    found = re.compile(rb"-?\d+(\.\d+)?").search(text, place)
    if not found:
        return text
    return text[: found.start()] + dice.choice(NUMBERS) + text[found.end() :]
