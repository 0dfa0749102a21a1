#!/usr/bin/env python3
"""Writes long programs as CAM posts write them, the same each time, to measure planning with.

    python tools/long-programs.py FOLDER [LINES]      LINES: 100000, unless said

    surface     rows of chords of 0.05 to 0.5 mm over a wavy surface
    trochoids   circles of 3 mm that move along, as chords of 0.36 mm
    arcs        half circles of 2 and 2.2 mm, each beginning where the one before ends
    corners     lines of 0.2 to 5 mm that turn by multiples of 45 degrees
    mixed       pockets of arcs, outlines of short chords and drops into the work, with rapids between and feeds of all kinds
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Iterator
from pathlib import Path

HEAD = "G21 G90 G17\nG64 P0.01\nS6000 M3\nG0 X0 Y0 Z5\nG1 Z0 F6000"


def surface(rng: random.Random) -> Iterator[str]:
    x, y, way = 0.0, 0.0, 1
    while True:
        while 0 <= x <= 100:
            x += way * rng.uniform(0.05, 0.5)
            yield f"X{x:.4f} Y{y:.4f} Z{2 * math.sin(x / 7) * math.cos(y / 9):.4f}"
        x, y, way = min(max(x, 0.0), 100.0), (y + 0.3) % 100, -way


def trochoids(_rng: random.Random) -> Iterator[str]:
    while True:
        for step in range(20_000):
            t = 0.12 * step
            yield f"X{20 + 0.05 * t + 3 * math.cos(t):.4f} Y{30 + 3 * math.sin(t):.4f}"


def arcs(_rng: random.Random) -> Iterator[str]:
    while True:
        yield "G0 X90 Y30"
        for step in range(200):
            x = 90 - 0.4 * step
            yield from (f"G2 X{x + 4:.4f} I2 J0", f"G3 X{x - 0.4:.4f} I-2.2 J0")


def corners(rng: random.Random) -> Iterator[str]:
    x = y = 10.0
    while True:
        angle, length = math.radians(rng.choice([0, 45, 90, 135, 180, 270])), rng.uniform(0.2, 5)
        to = x + length * math.cos(angle), y + length * math.sin(angle)
        if all(1 < place < 99 for place in to):
            x, y = to
            yield f"X{x:.4f} Y{y:.4f}"


def mixed(rng: random.Random) -> Iterator[str]:
    while True:
        x, y = rng.uniform(20, 80), rng.uniform(20, 80)
        yield from ("G0 Z5", f"X{x:.3f} Y{y:.3f}", f"G1 Z-1 F{rng.choice([300, 1200, 3000])}")
        kind = rng.random()
        if kind < 0.4:
            for turn in range(1, 30):
                yield f"G1 X{x + 0.3 * turn:.4f} Y{y:.4f} F{rng.choice([1500, 4000])}"
                yield f"G2 I{-0.3 * turn:.4f}"
        elif kind < 0.8:
            t = 0.0
            for _ in range(rng.randint(200, 3000)):
                t += rng.uniform(0.01, 0.05)
                r = 5 + 2 * math.sin(5 * t)
                yield f"G1 X{x + r * math.cos(t) - 5:.4f} Y{y + r * math.sin(t):.4f} F5000"
        else:
            for _ in range(rng.randint(10, 60)):
                yield from ("G0 Z2", f"X{rng.uniform(1, 99):.3f} Y{rng.uniform(1, 99):.3f}", "G1 Z-2 F400")


def main() -> None:
    if len(sys.argv) not in (2, 3) or sys.argv[1].startswith("-") or not sys.argv[-1].isdigit() and len(sys.argv) == 3:
        sys.exit(__doc__)
    folder, count = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) == 3 else 100_000
    folder.mkdir(parents=True, exist_ok=True)
    for kind in (surface, trochoids, arcs, corners, mixed):
        lines = kind(random.Random(4))
        text = "\n".join([HEAD, *(next(lines) for _ in range(count)), "G0 Z5", "M2", ""])
        (folder / f"{kind.__name__}.ngc").write_text(text)


if __name__ == "__main__":
    main()
