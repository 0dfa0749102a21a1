#!/usr/bin/env python3
"""Writes the programs that path planners are compared on, the same each time, without a path mode: the table states each.

    python tools/planner-programs.py FOLDER

    surface     6000 points, 0.25 mm apart in rows of 400, over a wavy surface, F6000
    sine-S      one sine of 2 mm over 150 mm, in chords whose X is S mm: 0.2, 0.1, 0.05, 0.02, 0.01; F9000
    raster      121 rows of 601 points, 0.1 mm apart, over another surface, F6000
    sharp       zigzags, squares and spikes: corners that cannot be taken at speed, F6000
    contour     a turned contour in X and Z of 1400 short lines, F1500
    trochoids   circles of 3 mm that move along, as chords of 0.36 mm, F6000
    chips       short drops into the work with rapids between, and outlines of chords of 0.02 to 0.3 mm, F800 to F5000
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Iterator
from pathlib import Path

HEAD = "G21 G17 G90 G94 G40 G49 G80"


def surface() -> Iterator[str]:
    yield from ("G0 X0 Y0 Z5", "G1 Z-3 F6000")
    for i in range(6000):
        row, k = divmod(i, 400)
        x, y = (k if row % 2 == 0 else 399 - k) * 0.25, row * 0.2
        z = -3.0 + 2.5 * math.sin(x * 0.11) * math.cos(y * 0.07) + 0.4 * math.sin(0.9 * x + 0.3 * y)
        yield f"X{x:.3f} Y{y:.3f} Z{z:.3f}"
    yield "G0 Z5"


def sine(chord: float) -> Iterator[str]:
    yield from ("G0 X0 Y0 Z0", "F9000", "G1")
    for i in range(1, int(150 / chord) + 1):
        yield f"X{i * chord:.4f} Y{2 * math.sin(i * chord * 0.5):.4f}"


def raster() -> Iterator[str]:
    yield from ("G0 X0 Y0 Z10", "F6000")
    for row in range(121):
        y = row * 0.5
        for k in range(601) if row % 2 == 0 else range(600, -1, -1):
            x = k * 0.1
            z = 3 * math.sin(x / 6) * math.cos(y / 7) + 1.5 * math.sin(x / 2.3 + y / 3.1)
            yield f"G1 X{x:.3f} Y{y:.3f} Z{z:.4f}"
    yield "G0 Z10"


def sharp() -> Iterator[str]:
    yield from ("G0 X0 Y0 Z0", "G1 F6000")
    for k in range(500):
        yield f"G1 X{k:.3f} Y{10 * (k % 2)}"
    yield "G1 X0 Y20"
    for k in range(250):
        side = 1 + k * 0.1
        yield from (f"G1 X{side:.3f} Y20", f"G1 X{side:.3f} Y{20 + side:.3f}")
        yield from (f"G1 X0 Y{20 + side:.3f}", "G1 X0 Y20")
    for k in range(500):
        yield from (f"G1 X{2 * k + 1} Y23.7321", f"G1 X{2 * k + 2} Y20")


def contour() -> Iterator[str]:
    yield from ("G0 X20 Y0 Z2", "F1500", "G1 Z0")
    for k in range(1, 1401):
        z = -0.04 * k
        yield f"G1 X{20 + 3 * math.sin(z / 4) + 0.8 * math.sin(z * 1.9):.4f} Z{z:.4f}"


def trochoids() -> Iterator[str]:
    yield from ("G0 X0 Y0 Z0", "G1 F6000")
    for step in range(6000):
        t = 0.12 * step
        yield f"X{20 + 0.05 * t + 3 * math.cos(t):.4f} Y{30 + 3 * math.sin(t):.4f}"


def chips() -> Iterator[str]:
    rng = random.Random(5)
    yield "G0 X0 Y0 Z5"
    for _ in range(25):
        x, y, t = rng.uniform(0, 80), rng.uniform(0, 80), 0.0
        yield from (f"G0 X{x + 4:.3f} Y{y:.3f}", f"G1 Z-{rng.uniform(0.2, 1):.3f} F800", "F5000")
        for _ in range(rng.randint(40, 160)):
            t += rng.uniform(0.005, 0.075)
            r = 4 + math.sin(7 * t)
            yield f"G1 X{x + r * math.cos(t):.4f} Y{y + r * math.sin(t):.4f}"
        yield "G0 Z2"


PROGRAMS = {
    "surface": surface(),
    **{f"sine-{chord:g}": sine(chord) for chord in (0.2, 0.1, 0.05, 0.02, 0.01)},
    "raster": raster(),
    "sharp": sharp(),
    "contour": contour(),
    "trochoids": trochoids(),
    "chips": chips(),
}


def write(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, lines in PROGRAMS.items():
        (folder / f"{name}.ngc").write_text("\n".join([HEAD, *lines, "M2", ""]))


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    write(Path(sys.argv[1]))
