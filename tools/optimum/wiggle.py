#!/usr/bin/env python3
"""How long a sine in chords must take at least, if the path is within P of the chords on both sides: docs/planner.md has why.

The sine is y = 2·sin(x/2) over 150 mm, F9000; X and Y 200 mm/s and 1000 mm/s². Standard library only.
"""
import math

from topp import ACCEL, fastest, held

FEED = 150.0
CHORD, P = 0.2, 0.001
STEPS = 30_000
DX = 150.0 / STEPS


def cap(slope, bend, jerk):
    """dx/dt that the wiggle leaves; both axes help each other as if all their limits were free for it."""
    along = math.hypot(1.0, slope)
    helped = (1.0 + abs(slope)) / along
    curvature, chord = abs(bend) / along**3, CHORD * along
    swing = curvature * chord**2 / 8.0 - 2.0 * P
    if swing <= 0.0:
        return held(FEED, slope)
    if math.isfinite(jerk):
        speed = chord / 2.0 * (jerk * helped / (12.0 * swing)) ** (1.0 / 3.0)
    else:
        accel = ACCEL * helped
        a, half = curvature**2 / accel, 8.0 * swing / chord**2
        speed = math.sqrt((math.sqrt(half**2 + a * accel) - half) / a)
    return min(held(FEED, slope), speed / along)


def main():
    places = [k * DX for k in range(STEPS + 1)]
    slope, bend = [math.cos(x / 2.0) for x in places], [-0.5 * math.sin(x / 2.0) for x in places]
    least = fastest(slope, bend, [held(FEED, s) for s in slope], DX)
    print(f"without a wiggle {least:.3f} s")
    for name, jerk in (("no limit of jerk", math.inf), ("50 m/s³", 50e3), ("20 m/s³", 20e3)):
        time = fastest(slope, bend, [cap(s, c, jerk) for s, c in zip(slope, bend)], DX)
        print(f"{name}: {time:.3f} s, {100.0 * (time / least - 1.0):.1f} % more")


if __name__ == "__main__":
    main()
