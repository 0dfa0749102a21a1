#!/usr/bin/env python3
"""How long raster takes if its rows are followed exactly: the surface itself, not its points. rows.py [--jerk]

Its rows are 0.5 mm apart, 60 mm long, F6000; at their ends X rests while Y goes 0.5 mm, and either axis may begin while the
other one comes to rest as long as P on both sides of the corner lasts. Standard library only; with --jerk also for 20 m/s³,
every twelfth row by the method of reference.py, which needs numpy and cvxpy (a minute).
"""
import math, sys

from topp import ACCEL, fastest, held

FEED, P = 100.0, 0.01
ROWS, LENGTH, APART, CLEARANCE = 121, 60.0, 0.5, 10.0
JERK = 20e3


def surface(x, y):
    """First to third derivative by x of z = 3·sin(x/6)·cos(y/7) + 1.5·sin(x/2.3 + y/3.1)."""
    long, short, across = x / 6.0, x / 2.3 + y / 3.1, 3.0 * math.cos(y / 7.0)
    return (
        across / 6.0 * math.cos(long) + 1.5 / 2.3 * math.cos(short),
        -across / 6.0**2 * math.sin(long) - 1.5 / 2.3**2 * math.sin(short),
        -across / 6.0**3 * math.cos(long) - 1.5 / 2.3**3 * math.cos(short),
    )


def row(y, steps=3000):
    dx = LENGTH / steps
    slope, bend, _ = zip(*(surface(k * dx, y) for k in range(steps + 1)))
    return fastest(slope, bend, [held(FEED, s) for s in slope], dx)


def row_with_jerk(y, steps=1200):
    import numpy as np
    from reference import optimum

    dx = LENGTH / steps
    q = np.zeros((steps, 3, 3, 3))
    q[:, :, 0, 0] = 1.0
    for k in range(steps):
        for place in range(3):
            q[k, place, 2] = surface((k + place / 2.0) * dx, y)
    feed = FEED / np.hypot(1.0, q[:, 1, 2, 0])
    return optimum(np.full(steps, dx), feed, q, JERK)


def shown(name, rows, stop, corner, way):
    """`corner`: how long both axes go at once; `way(mm)`: time from rest to rest; `stop`: of a row's ends, not in its time."""
    ends = ROWS * stop + (ROWS - 1) * (way(APART) - 2.0 * corner)
    lifts = 2.0 * way(CLEARANCE)
    print(f"{name}: {ROWS} rows {rows:.1f} s, their ends {ends:.1f} s, down and up {lifts:.1f} s: {rows + ends + lifts:.1f} s")


def way_with_jerk(way):
    """Acceleration up, level, and down, and the same again to rest."""
    if way <= 2.0 * ACCEL**3 / JERK**2:
        return 4.0 * (way / (2.0 * JERK)) ** (1.0 / 3.0)
    ramp = ACCEL / JERK
    return ramp + math.sqrt(ramp**2 + 4.0 * way / ACCEL)


def main():
    rows = sum(row(APART * k) for k in range(ROWS))
    # from P outside of one line to P inside, both axes at once: A·(t/2)²/2 = 2·P, or J·(t/2)³/6
    shown("no limit of jerk", rows, 0.0, 4.0 * math.sqrt(P / ACCEL), lambda way: 2.0 * math.sqrt(way / ACCEL))
    if "--jerk" in sys.argv[1:]:
        some = [row_with_jerk(APART * k) for k in range(0, ROWS, 12)]
        # the reference begins and ends with all of its acceleration: half a ramp more at both ends
        shown("20 m/s³", sum(some) / len(some) * ROWS, ACCEL / JERK, 2.0 * (12.0 * P / JERK) ** (1.0 / 3.0), way_with_jerk)


if __name__ == "__main__":
    main()
