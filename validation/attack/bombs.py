"""Films of a few hundred bytes with headers that claim thousands of megapixels, for every codec and header."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path

from program import run, temporary

HUGE, SMALL = 65535, 64

SYNTAXES = {
    "plain": "1.2.840.10008.1.2.1",
    "deflated": "1.2.840.10008.1.2.1.99",
    "rle": "1.2.840.10008.1.2.5",
    "jpeg": "1.2.840.10008.1.2.4.50",
    "jpeg 12 bit": "1.2.840.10008.1.2.4.51",
    "jpeg lossless": "1.2.840.10008.1.2.4.70",
    "jpeg-ls": "1.2.840.10008.1.2.4.80",
    "jpeg-ls near": "1.2.840.10008.1.2.4.81",
    "jpeg 2000 lossless": "1.2.840.10008.1.2.4.90",
    "jpeg 2000": "1.2.840.10008.1.2.4.91",
    "high-throughput jpeg 2000": "1.2.840.10008.1.2.4.201",
    "jpeg xl": "1.2.840.10008.1.2.4.110",
}


def element(group: int, number: int, kind: bytes, value: bytes) -> bytes:
    """One element, explicit VR, little endian."""
    value += b"\x00" * (len(value) % 2)
    long = kind in (b"OB", b"OW", b"SQ", b"UN")
    length = struct.pack("<HI", 0, len(value)) if long else struct.pack("<H", len(value))
    return struct.pack("<HH", group, number) + kind + length + value


def film(syntax: str, rows: int, columns: int, stream: bytes, frames: bytes = b"1") -> bytes:
    """A radiograph whose pixels are a stream of the syntax."""
    uid = SYNTAXES[syntax].encode()
    meta = element(2, 1, b"OB", b"\x00\x01") + element(2, 2, b"UI", b"1.2.840.10008.5.1.4.1.1.1.1")
    meta += element(2, 3, b"UI", b"1.2.3") + element(2, 0x10, b"UI", uid)
    short = lambda number: struct.pack("<H", number)
    data = element(8, 0x16, b"UI", b"1.2.840.10008.5.1.4.1.1.1.1") + element(8, 0x18, b"UI", b"1.2.3")
    data += element(8, 0x60, b"CS", b"DX") + element(0x28, 2, b"US", short(1))
    data += element(0x28, 4, b"CS", b"MONOCHROME2") + element(0x28, 8, b"IS", frames)
    data += element(0x28, 0x10, b"US", short(rows)) + element(0x28, 0x11, b"US", short(columns))
    data += element(0x28, 0x100, b"US", short(16)) + element(0x28, 0x101, b"US", short(16))
    data += element(0x28, 0x102, b"US", short(15)) + element(0x28, 0x103, b"US", short(0))
    if syntax in ("plain", "deflated"):
        data += element(0x7FE0, 0x10, b"OW", stream)
    else:
        stream += b"\x00" * (len(stream) % 2)
        data += struct.pack("<HH", 0x7FE0, 0x10) + b"OB" + struct.pack("<HI", 0, 0xFFFFFFFF)
        data += struct.pack("<HHI", 0xFFFE, 0xE000, 0)
        data += struct.pack("<HHI", 0xFFFE, 0xE000, len(stream)) + stream
        data += struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)
    if syntax == "deflated":
        import zlib

        packer = zlib.compressobj(9, zlib.DEFLATED, -15)
        data = packer.compress(data) + packer.flush()
    return b"\x00" * 128 + b"DICM" + element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta + data


def jpeg(start: int, rows: int, columns: int, bits: int) -> bytes:
    """A stream of ISO 10918 or 14495 with one component and almost no data."""
    frame = struct.pack(">BHHBBBB", bits, rows, columns, 1, 1, 0x11, 0)
    scan = bytes((1, 1, 0, 0, 0, 0) if start == 0xF7 else (1, 1, 0, 1, 0, 0))
    table = b"\xff\xc4" + struct.pack(">H", 20) + bytes((0, 1)) + bytes(15) + bytes((0,))
    return (
        b"\xff\xd8\xff" + bytes((start,)) + struct.pack(">H", len(frame) + 2) + frame
        + (b"" if start == 0xF7 else table)
        + b"\xff\xda" + struct.pack(">H", len(scan) + 2) + scan + bytes(200) + b"\xff\xd9"
    )


def jpeg_2000(rows: int, columns: int, tile: int, levels: int = 5) -> bytes:
    """A codestream of ISO 15444 whose tiles are empty."""
    size = struct.pack(">HIIIIIIIIH", 0, columns, rows, 0, 0, tile, tile, 0, 0, 1) + bytes((15, 1, 1))
    style = bytes((0, 0)) + struct.pack(">H", 1) + bytes((0, levels, 4, 4, 0, 1))
    quantities = bytes((0x40,)) + bytes(8 for _ in range(3 * levels + 1))
    part = lambda code, body: b"\xff" + bytes((code,)) + struct.pack(">H", len(body) + 2) + body
    start = part(0x90, struct.pack(">HIBB", 0, 0, 0, 1)) + b"\xff\x93" + bytes(40)
    return b"\xff\x4f" + part(0x51, size) + part(0x52, style) + part(0x5C, quantities) + start + b"\xff\xd9"


def streams(rows: int, columns: int) -> dict[str, list[bytes]]:
    """Streams of every codec that claim a size."""
    lossless = [jpeg(0xC3, rows, columns, 16)]
    nearly = [jpeg(0xF7, rows, columns, 16)]
    tiles = [jpeg_2000(rows, columns, max(rows, columns)), jpeg_2000(rows, columns, 1), jpeg_2000(rows, columns, 64, 32)]
    rle = struct.pack("<16I", 2, 64, 80, *([0] * 13)) + b"\x81\x00" * 200
    return {
        "plain": [bytes(64)],
        "deflated": [bytes(40_000_000)],
        "rle": [rle, struct.pack("<16I", 15, *([0xFFFFFFF0] * 15)), b"\xff" * 64],
        "jpeg": [jpeg(0xC0, rows, columns, 8)],
        "jpeg 12 bit": [jpeg(0xC1, rows, columns, 12)],
        "jpeg lossless": lossless,
        "jpeg-ls": nearly,
        "jpeg-ls near": nearly,
        "jpeg 2000 lossless": tiles,
        "jpeg 2000": tiles,
        "high-throughput jpeg 2000": tiles,
        "jpeg xl": [b"\xff\x0a" + b"\xff" * 60],
    }


def bombs() -> Iterator[tuple[str, bytes]]:
    """Bombs by name: file and stream claim the same or different sizes, or too many frames."""
    sizes = ((HUGE, HUGE), (HUGE, 1), (1, HUGE), (20_000, 20_000), (0, 0))
    for rows, columns in sizes:
        for syntax, found in streams(rows, columns).items():
            for number, stream in enumerate(found):
                yield f"{syntax} {number}, both say {rows} x {columns}", film(syntax, rows, columns, stream)
                yield f"{syntax} {number}, the stream says {rows} x {columns}", film(syntax, SMALL, SMALL, stream)
    for syntax, found in streams(SMALL, SMALL).items():
        yield f"{syntax}, the file says {HUGE} x {HUGE}", film(syntax, HUGE, HUGE, found[0])
        yield f"{syntax}, a million frames", film(syntax, SMALL, SMALL, found[0], b"1000000")


def attack(program: Path) -> Iterator[str]:
    """Faults over all bombs: each is an error with a reason, before memory is spent."""
    count, largest = 0, 0.0
    with temporary() as place:
        for name, data in bombs():
            path = Path(place) / "bomb.dcm"
            path.write_bytes(data)
            end = run(program, ["film", "bomb.dcm", "--png", "bomb.png"], path.parent)
            count, largest = count + 1, max(largest, end.resident_mb)
            yield from (f"{name}: {fault}" for fault in end.faults())
            (path.parent / "bomb.png").unlink(missing_ok=True)
    print(f"{count:4} bombs of {len(SYNTAXES)} codecs, at most {largest:.0f} MB")
