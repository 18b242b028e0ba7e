"""Damaged copies of files, from a seed."""

from __future__ import annotations

import random
import re

# Replacements for numbers of a text.
NUMBERS = (b"1e400", b"-1e400", b"NaN", b"1e308", b"-0", b"0", b"4294967296", b"-1", b"1e-320", b"99999999999999999999", b"null", b'""')
WORDS = (b"\xff\xfe", b"\x00", b"{", b"[" * 2000, b'"\\ud800"', b"=cmd|' /C calc'!A0", b"\xe2\x80\xae", b"\x1b[2J\n", b"\\u001b[2J\\n\\u202e", b"A" * 100_000, b",,,,")


def damaged(data: bytes, rng: random.Random) -> bytes:
    """A copy with one to four faults: cut, overwritten, bits turned, parts repeated or moved, numbers replaced."""
    copy = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        if not copy:
            break
        # Half of the faults are near the headers.
        place = rng.randrange(len(copy) if rng.random() < 0.5 else min(len(copy), 2000))
        kind = rng.randrange(8)
        if kind == 0:
            del copy[place:]
        elif kind == 1:
            copy[place] = rng.randrange(256)
        elif kind == 2:
            copy[place] ^= 1 << rng.randrange(8)
        elif kind == 3:
            end = min(len(copy), place + rng.randint(1, 4000))
            copy[place:place] = copy[place:end]
        elif kind == 4:
            del copy[place : place + rng.randint(1, 400)]
        elif kind == 5:
            copy[place:place] = rng.choice(WORDS)
        elif kind == 6 and len(copy) >= 8:
            place = rng.randrange(len(copy) - 7)
            copy[place : place + 4] = rng.choice((b"\xff\xff\xff\xff", b"\x00\x00\x00\x00", b"    ", b"\xff\xff\xff\x7f"))
        else:
            copy = replaced_number(copy, rng)
    return bytes(copy)


def replaced_number(text: bytearray, rng: random.Random) -> bytearray:
    """Replaces a number near a random place."""
    place = rng.randrange(len(text))
    found = re.compile(rb"-?\d+(\.\d+)?").search(text, place)
    if not found:
        return text
    return text[: found.start()] + rng.choice(NUMBERS) + text[found.end() :]
