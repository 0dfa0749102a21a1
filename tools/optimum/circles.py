#!/usr/bin/env python3
"""The least time along circles and helices from rest to rest, and what `leadscrew time` takes: circles.py [LEADSCREW]

The least time is by reachability, backwards and forwards, on 1500 places a turn, without a limit of jerk: each axis has 200 mm/s and
1000 mm/s² as on machine bench-xyz. Each circle is planned in 1, 2, 3, 7 and 50 arcs, without a limit of jerk and with 20 m/s³; the last
column is how much longer the slowest of the five takes than the quickest, with jerk. Standard library only.
"""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

SPEED, ACCEL, PLACES = 200.0, 1000.0, 1500
PARTS = (1, 2, 3, 7, 50)


def derivatives(radius, pitch, angle):
    """dq/ds and d²q/ds² of X, Y, Z by the length."""
    length = math.hypot(radius, pitch / math.tau)
    share = radius / length
    first = (-math.sin(angle) * share, math.cos(angle) * share, pitch / math.tau / length)
    return first, (-math.cos(angle) * share / length, -math.sin(angle) * share / length, 0.0)


def room(rows, b):
    """Lowest and highest s̈ where ṡ² = b, at both ends of a stretch; the first above the second where there is none."""
    low, high = -math.inf, math.inf
    for one, two in rows:
        if abs(one) < 1e-12:
            if abs(two * b) > ACCEL * (1.0 + 1e-12):
                return 1.0, -1.0
        else:
            middle, width = -two * b / one, ACCEL / abs(one)
            low, high = max(low, middle - width), min(high, middle + width)
    return low, high


def least(radius, pitch, turns, begins):
    count = round(PLACES * turns)
    step = math.hypot(radius * math.tau, pitch) * turns / count
    all_ = [derivatives(radius, pitch, begins + math.tau * turns * k / count) for k in range(count + 1)]
    cap = [min(SPEED / max(abs(x), 1e-12) for x in first) ** 2 for first, _ in all_]
    rows = [
        [(one, two) for one, two in zip(*all_[k])] + [(one + 2.0 * step * two, two) for one, two in zip(*all_[k + 1])]
        for k in range(count)
    ]
    most = [0.0] * (count + 1)
    for k in reversed(range(count)):

        def reaches(b):
            lowest, highest = room(rows[k], b)
            return lowest <= min(highest, (most[k + 1] - b) / (2.0 * step)) and highest >= -b / (2.0 * step)

        low, high = 0.0, cap[k]
        if reaches(high):
            low = high
        else:
            for _ in range(45):
                middle = (low + high) / 2.0
                low, high = (middle, high) if reaches(middle) else (low, middle)
        most[k] = low
    b, time = 0.0, 0.0
    for k in range(count):
        after = max(0.0, min(most[k + 1], b + 2.0 * step * room(rows[k], b)[1]))
        time += 2.0 * step / (math.sqrt(b) + math.sqrt(after))
        b = after
    return time


def program(radius, pitch, turns, begins, parts):
    """It begins at X0 Y0 Z0, where a program begins on bench-xyz: so the circle is all that moves."""
    centre = (-radius * math.cos(begins), -radius * math.sin(begins))
    lines, at = ["G21 G90 G17 G64 P0.001 F60000"], (0.0, 0.0)
    for k in range(1, parts * turns + 1):
        angle = begins + math.tau * (k % parts) / parts
        to = (0.0, 0.0) if k % parts == 0 else (centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle))
        lines.append(f"G3 X{to[0]:.9f} Y{to[1]:.9f} Z{pitch * k / parts:.9f} I{centre[0] - at[0]:.9f} J{centre[1] - at[1]:.9f}")
        at = to
    return "\n".join([*lines, "M2", ""])


def taken(leadscrew, machine, text):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "circle.ngc"
        path.write_text(text)
        command = [leadscrew, "time", "--machine", machine, "--format", "json", "--quiet", str(path)]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["feed_time_s"]


def main():
    if {"-h", "--help"} & set(sys.argv):
        print(__doc__)
        return
    leadscrew = sys.argv[1] if len(sys.argv) > 1 else "target/release/leadscrew"
    print("| R mm | pitch mm | turns | begins at rad | least s | s | over it | cut, none | cut, 20 m/s³ |\n|" + "---|" * 9)
    for radius, pitch in ((2.0, 0.0), (10.0, 0.0), (40.0, 0.0), (10.0, 5.0)):
        for turns in (1, 3):
            for begins in (0.0, 0.3, 1.0):
                texts = [program(radius, pitch, turns, begins, parts) for parts in PARTS]
                bound = least(radius, pitch, turns, begins)
                none = [taken(leadscrew, "bench-xyz", text) for text in texts]
                jerk = [taken(leadscrew, "bench-xyz-jerk20", text) for text in texts]
                spread = [f"{max(times) / min(times):.4f}" for times in (none, jerk)]
                print(f"| {radius:g} | {pitch:g} | {turns} | {begins:g} | {bound:.4f} | {none[0]:.4f} | {none[0] / bound:.4f} | {' | '.join(spread)} |", flush=True)


main()
