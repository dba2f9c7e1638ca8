"""Eight-bit RGB PNG files, and the sRGB curve they are stored with."""

import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def srgb8(linear):
    """The sRGB byte of one linear component, clamped to [0, 1]."""
    c = min(max(linear, 0.0), 1.0)
    encoded = 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055
    return int(encoded * 255 + 0.5)


def _chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def encode(width, rows):
    """A PNG from `rows`, top row first, each `3 * width` sRGB bytes."""
    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    up = 2  # every row is stored as its difference from the row above
    data, above = bytearray(), bytes(3 * width)
    for row in rows:
        data.append(up)
        data += bytes((a - b) & 255 for a, b in zip(row, above))
        above = row
    return (SIGNATURE + _chunk(b"IHDR", header) + _chunk(b"IDAT", zlib.compress(bytes(data), 9)) + _chunk(b"IEND", b""))


def decode(content):
    """Header and unpacked data of a PNG, or None where `content` is none: enough to tell two pictures apart."""
    if content[:8] != SIGNATURE:
        return None
    header, packed, at = b"", b"", 8
    try:
        while at < len(content):
            (length,) = struct.unpack_from(">I", content, at)
            kind, data = content[at + 4 : at + 8], content[at + 8 : at + 8 + length]
            header += data if kind == b"IHDR" else b""
            packed += data if kind == b"IDAT" else b""
            at += 12 + length
        return header, zlib.decompress(packed)
    except (struct.error, zlib.error):
        return None
