#!/usr/bin/env python3
"""How long a sine in chords must take at least, if the path is within P of the chords on both sides: docs/planner.md has why.

The sine is y = 2·sin(x/2) over 150 mm, F9000; X and Y 200 mm/s and 1000 mm/s². Standard library only.
"""
import math

SPEED, ACCEL, FEED = 200.0, 1000.0, 150.0
CHORD, P = 0.2, 0.001
STEPS = 30_000
DX = 150.0 / STEPS


def slope(x):
    return math.cos(x / 2.0)


def bend(x):
    return -0.5 * math.sin(x / 2.0)


def room(x, b):
    """Lowest and highest d²x/dt² where (dx/dt)² = b."""
    low, high = -ACCEL, ACCEL
    if abs(slope(x)) > 1e-9:
        middle, width = -bend(x) * b / slope(x), ACCEL / abs(slope(x))
        low, high = max(low, middle - width), min(high, middle + width)
    return low, high


def fastest(cap):
    """Time along the sine with dx/dt at most cap(x), from rest to rest: reachability, backwards and forwards."""
    places = [k * DX for k in range(STEPS + 1)]
    most = [min(cap(x) ** 2, ACCEL * (1.0 + abs(slope(x))) / max(abs(bend(x)), 1e-12)) for x in places]
    most[-1] = 0.0
    for k in reversed(range(STEPS)):
        def reaches(b):
            low, high = room(places[k], b)
            return low <= min(high, (most[k + 1] - b) / (2.0 * DX))

        if not reaches(most[k]):
            low, high = 0.0, most[k]
            for _ in range(40):
                middle = (low + high) / 2.0
                low, high = (middle, high) if reaches(middle) else (low, middle)
            most[k] = low
    b, time = 0.0, 0.0
    for k in range(STEPS):
        after = max(0.0, min(most[k + 1], b + 2.0 * DX * room(places[k], b)[1]))
        time += 2.0 * DX / (math.sqrt(b) + math.sqrt(after))
        b = after
    return time


def plain(x):
    along = math.hypot(1.0, slope(x))
    return min(FEED / along, SPEED, SPEED / max(abs(slope(x)), 1e-9))


def wiggling(jerk):
    """dx/dt that the wiggle leaves; both axes help each other as if all their limits were free for it."""

    def cap(x):
        along = math.hypot(1.0, slope(x))
        helped = (1.0 + abs(slope(x))) / along
        curvature, chord = abs(bend(x)) / along**3, CHORD * along
        swing = curvature * chord**2 / 8.0 - 2.0 * P
        if swing <= 0.0:
            return plain(x)
        if math.isfinite(jerk):
            speed = chord / 2.0 * (jerk * helped / (12.0 * swing)) ** (1.0 / 3.0)
        else:
            accel = ACCEL * helped
            a, half = curvature**2 / accel, 8.0 * swing / chord**2
            speed = math.sqrt((math.sqrt(half**2 + a * accel) - half) / a)
        return min(plain(x), speed / along)

    return cap


def main():
    least = fastest(plain)
    print(f"without a wiggle {least:.3f} s")
    for name, jerk in (("no limit of jerk", math.inf), ("50 m/s³", 50e3), ("20 m/s³", 20e3)):
        time = fastest(wiggling(jerk))
        print(f"{name}: {time:.3f} s, {100.0 * (time / least - 1.0):.1f} % more")


if __name__ == "__main__":
    main()
