"""The least time along a curve y(x) of two axes, exactly along it, from rest to rest: reachability, backwards and forwards.

X and the other axis 200 mm/s and 1000 mm/s², no limit of jerk. Standard library only.
"""
import math

SPEED, ACCEL = 200.0, 1000.0


def held(feed, slope):
    """dx/dt at most, by the feed along the curve and the axes' speeds."""
    return min(feed / math.hypot(1.0, slope), SPEED, SPEED / max(abs(slope), 1e-9))


def room(slope, bend, b):
    """Lowest and highest d²x/dt² where (dx/dt)² = b."""
    low, high = -ACCEL, ACCEL
    if abs(slope) > 1e-9:
        middle, width = -bend * b / slope, ACCEL / abs(slope)
        low, high = max(low, middle - width), min(high, middle + width)
    return low, high


def fastest(slope, bend, cap, dx):
    """Time, from dy/dx, d²y/dx² and the highest dx/dt at places that are dx apart."""
    last = len(slope) - 1
    most = [min(v * v, ACCEL * (1.0 + abs(s)) / max(abs(c), 1e-12)) for v, s, c in zip(cap, slope, bend)]
    most[last] = 0.0
    for k in reversed(range(last)):
        def reaches(b):
            low, high = room(slope[k], bend[k], b)
            return low <= min(high, (most[k + 1] - b) / (2.0 * dx))

        if not reaches(most[k]):
            low, high = 0.0, most[k]
            for _ in range(40):
                middle = (low + high) / 2.0
                low, high = (middle, high) if reaches(middle) else (low, middle)
            most[k] = low
    b, time = 0.0, 0.0
    for k in range(last):
        after = max(0.0, min(most[k + 1], b + 2.0 * dx * room(slope[k], bend[k], b)[1]))
        time += 2.0 * dx / (math.sqrt(b) + math.sqrt(after))
        b = after
    return time
