#!/usr/bin/env python3
"""How long a program of lines must take at least, however it is joined within P. least.py [--jerk] PROGRAM ...

X, Y and Z 200 mm/s and 1000 mm/s² each, with --jerk 20 m/s³. A path that goes along the lines in their order, within P of them and
within sqrt(2)*P of each of their ends (D below), comes within D of every place of theirs, one after the other. Of each axis alone it follows then:

  - Where the lines turn back by more than 2*D, the axis comes to rest, at most D before the turning point and P behind it.
  - Between two such rests it takes 2*sqrt(way/A) or more; on the way v*v <= 2*A*(way to either of them).

So from one place to another each axis needs a time of its own, and all of them together the longest of these, or the distance
over the feed. Of all ways to divide the lines at such places, the one with the largest sum is found (dynamic programming).
Needs numpy, and target/release/leadscrew, which reads the program. Prints a table.
"""
import argparse, math, pathlib, re, subprocess, sys
import numpy as np

SPEED, ACCEL, JERK = 200.0, 1000.0, 20e3
LEADSCREW = pathlib.Path(__file__).resolve().parents[2] / "target/release/leadscrew"
PLACE = re.compile(r"STRAIGHT_(FEED|TRAVERSE)\(([^)]*)\)|SET_FEED_RATE\(([^)]*)\)|MODE\(CANON_CONTINUOUS, ([^)]*)\)")
UNKNOWN = re.compile(r"ARC_FEED|NURBS|CANON_UNITS_INCHES")


def lines(program, tolerance, step):
    """P, and places at most so far apart, each with the feed to it (mm/s)."""
    words = [LEADSCREW, "canon", program, "--format", "linuxcnc"]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    if found := UNKNOWN.search(said):
        sys.exit(f"{program}: lines in mm only, found {found[0]}")
    stated = {float(p) for _, _, _, p in PLACE.findall(said) if p and float(p) > 0.0}
    if tolerance is None and len(stated) > 1:
        sys.exit(f"{program}: one P only, found {sorted(stated)}; --tolerance with the largest gives a bound")
    tolerance = tolerance or (stated or {0.01}).pop()
    places, feeds, feed = [np.zeros(3)], [math.inf], math.inf
    for kind, place, rate, _ in PLACE.findall(said):
        if rate:
            feed = float(rate) / 60.0
        if not place:
            continue
        to = np.array([float(word) for word in place.split(",")[:3]])
        if len(places) == 1 and kind == "TRAVERSE" and not places[0].any():
            places[0] = to  # the way to where all begins counts for nothing
        count = math.ceil(np.abs(to - places[-1]).max() / step)
        places += [places[-1] + (to - places[-1]) * k / count for k in range(1, count + 1)]
        feeds += [math.inf if kind == "TRAVERSE" else feed] * count
    return tolerance, np.array(places), np.array(feeds)


def turns(v, band):
    """Where v turns back by more than a band; its first and last place, too."""
    found, way, high, low = [0], 0, 0, 0
    for k, x in enumerate(v):
        high, low = (k if x > v[high] else high), (k if x < v[low] else low)
        if way >= 0 and x < v[high] - band:
            found += [high] if high > 0 else []
            way, low = -1, k
        elif way <= 0 and x > v[low] + band:
            found += [low] if low > 0 else []
            way, high = 1, k
    return sorted({*found, high if way > 0 else low, len(v) - 1})


def whole(way, jerk):
    """From v = 0 to v = 0, with any acceleration at both."""
    way, ramp = np.maximum(way, 0.0), ACCEL / jerk
    short, fast = np.cbrt(12.0 * way / jerk), way / SPEED
    level = np.sqrt(np.maximum(ramp**2 / 3.0 + way / ACCEL, 0.0)) - ramp
    return np.maximum(fast, np.where(level < 0.0, short, 2.0 * (level + ramp)))


def leaving(way):
    """Time from rest."""
    way = np.maximum(way, 0.0)
    return np.where(way < SPEED**2 / ACCEL / 2.0, np.sqrt(2.0 * way / ACCEL), way / SPEED + SPEED / ACCEL / 2.0)


def between(a, b, low, high):
    """From a to b on the way from a rest at `low` to one at `high`."""

    def since(x):
        half = (high - low) / 2.0
        x = np.clip(x - low, 0.0, 2.0 * half)
        return np.where(x <= half, leaving(x), 2.0 * leaving(half) - leaving(2.0 * half - x))

    return np.where(b > a, since(b) - since(a), 0.0)


class Axis:
    """Its runs between turns; x and y are ways along one of them."""

    def __init__(self, v, p, jerk):
        self.p, self.near = p, math.sqrt(2.0) * p
        at = turns(v, 2.0 * self.near)
        self.run = np.minimum(np.searchsorted(at, np.arange(len(v)), side="right") - 1, len(at) - 2)
        begin, end = v[at[:-1]], v[at[1:]]
        self.way = np.abs(end - begin)
        self.x = (v - begin[self.run]) * np.sign(end - begin)[self.run]
        self.sum = np.append(0.0, np.cumsum(whole(self.way - 2.0 * self.near, jerk)))

    def least(self, i, j):
        """From place i to the places j."""
        p, near, way, last = self.p, self.near, self.way, len(self.way) - 1
        r, s, x, y = self.run[i], self.run[j], self.x[i], self.x[j]
        alone = between(x + near, y - near, -p, way[r] + p)
        same = s == r
        # next to a turn it may be on either side of it: what is left is that of the other one
        if way[r] - x <= 2.0 * near and r < last:
            r, x = r + 1, way[r] - x
        back = (y <= 2.0 * near) & (s > 0)
        s, y = np.where(back, s - 1, s), np.where(back, way[s - 1] - y, y)
        ending = between(x + near, way[r] - near, -p, way[r] - near)
        begun = between(near, y - near, near, way[s] + p)
        apart = ending + self.sum[s] - self.sum[r + 1] + begun
        one = between(x + near, y - near, -p, way[r] + p)
        return np.where(same, alone, np.where(s > r, apart, np.where(s == r, one, 0.0)))


def least(program, jerk, words):
    p, q, feed = lines(program, words.tolerance, words.step)
    axes = [Axis(q[:, k], p, jerk) for k in range(3) if np.ptp(q[:, k]) > 0.0]
    best, near = np.zeros(len(q)), math.sqrt(2.0) * p
    for i in range(len(q) - 1):
        j = np.arange(i + 1, min(len(q), i + 1 + words.places))
        way = np.linalg.norm(q[j] - q[i], axis=1) - 2.0 * near
        time = np.maximum(way / np.maximum.accumulate(feed[j]), 0.0)
        for axis in axes:
            time = np.maximum(time, axis.least(i, j))
        best[j] = np.maximum(best[j], best[i] + time)
    return p, best[-1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jerk", action="store_true", help="20 m/s³")
    parser.add_argument("--tolerance", type=float, help="P, mm (the program's own, else 0.01)")
    parser.add_argument("--step", type=float, default=0.5, help="of the places on long lines, mm (0.5)")
    parser.add_argument("--places", type=int, default=1500, help="that a part may have (1500)")
    parser.add_argument("programs", nargs="+", type=pathlib.Path)
    words = parser.parse_args()
    print("| program | P mm | at least s |\n|---|---|---|")
    for program in words.programs:
        p, time = least(program, JERK if words.jerk else math.inf, words)
        print(f"| {program.stem} | {p:g} | {time:.2f} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
