#!/usr/bin/env python3
"""Judges taps and turned threads that halsampler has recorded in HAL.

hal-judge.py SAMPLES PITCH BOTTOM DEPTH TAPS
hal-judge.py threads SAMPLES PITCH FROM TO PASSES SLOWEST FASTEST

It knows nothing of who has commanded them. A tap is where the spindle turns back while Z stands deepest: on its thread
Z + PITCH * revolutions is a constant (right-hand, Z down), inward and outward the same one.

It fails unless there are TAPS of them, each within 10 um of its helix, within 2 um the same in and out, and within 50 um of BOTTOM.

A pass of a thread is where Z goes from FROM down to TO while the spindle turns forwards, PITCH a turn. Its phase is the mean of
Z + PITCH * revolutions there, of which whole pitches are left out. It fails unless there are PASSES of them, from SLOWEST to FASTEST
rev/min, within 3 um of one another.

columns of SAMPLES: X Y Z Z-told revolutions rev/s-told state sync-error; a row each millisecond; mm, revolutions
"""
import sys

PERIOD = 1e-3  # s


def rows(path):
    found = []
    for line in open(path):
        fields = line.split()
        if len(fields) == 8:  # a last row may be cut off
            found.append([float(field) for field in fields])
    return found


def reversals(z, turns):
    """Rows at which the spindle, having turned forwards, turns back below the Z of 0.3 s before and after."""
    reach, found, at = int(0.3 / PERIOD), [], 0
    for i in range(reach, len(z) - reach):
        forwards, back = turns[i] - turns[i - reach], turns[i] - turns[i + reach]
        deeper = min(z[i - reach], z[i + reach]) - z[i]
        if forwards > 0.5 and back > 0.5 and deeper > 0.5 and i - at > 2 * reach:
            window = range(i, min(i + 2 * reach, len(z)))
            at = max(window, key=lambda k: turns[k])
            found.append(at)
    return found


def judge(z, turns, bottom, pitch, depth):
    """What one tap left: the part of its travel within DEPTH of the bottom."""
    top = z[bottom] + depth
    first = bottom
    while first > 0 and z[first - 1] < top and turns[first - 1] <= turns[first] + 1e-3:
        first -= 1
    last = bottom
    while last + 1 < len(z) and z[last + 1] < top and turns[last + 1] <= turns[last] + 1e-3:
        last += 1
    line = [z[k] + pitch * turns[k] for k in range(first, last + 1)]
    inward, outward = line[: bottom - first], line[bottom - first :]
    middle = (max(line) + min(line)) / 2
    jumps = [(z[k + 1] - 2 * z[k] + z[k - 1]) / PERIOD**2 for k in range(first + 1, last)]
    ripple = [abs(a - b) for a, b in zip(jumps, jumps[1:])]
    return {
        "deepest": min(z[first : last + 1]),
        "error_um": max(abs(value - middle) for value in line) * 1e3,
        "shift_um": (sum(inward) / len(inward) - sum(outward) / len(outward)) * 1e3,
        "ripple": sorted(ripple)[int(len(ripple) * 0.99)],
        "seconds": (last - first) * PERIOD,
    }


def passes(z, turns, pitch, first, last):
    """Of each pass the rows in which Z is between FROM and TO."""
    found, rows = [], []
    for i in range(1, len(z)):
        dz, turned = z[i] - z[i - 1], turns[i] - turns[i - 1]
        cuts = turned > 0 and abs(dz + pitch * turned) < 0.3 * pitch * turned
        if last <= z[i] <= first and cuts:
            rows.append(i)
        elif not last <= z[i] <= first:
            if rows and z[rows[0]] - z[rows[-1]] > 0.9 * (first - last):
                found.append(rows)
            rows = []
    return found


def threads(path, pitch, first, last, count, slowest, fastest):
    table = rows(path)
    z, turns = [row[2] for row in table], [row[4] for row in table]
    measured = []
    for at in passes(z, turns, pitch, first, last):
        line = [z[k] + pitch * turns[k] for k in at]
        mean = sum(line) / len(line)
        rpm = (turns[at[-1]] - turns[at[0]]) / (at[-1] - at[0]) / PERIOD * 60
        measured.append((rpm, mean, max(abs(value - mean) for value in line)))
    if not measured:
        sys.exit(f"no pass in {path}")
    begin = measured[0][1]
    phases = [(mean - begin + pitch / 2) % pitch - pitch / 2 for _, mean, _ in measured]
    for number, ((rpm, _, most), phase) in enumerate(zip(measured, phases), 1):
        print(
            f"pass {number}: {rpm:.0f} rev/min, {phase * 1e3:+.2f} um from the first one, "
            f"{most * 1e3:.1f} um off its own line at most"
        )
    if len(measured) != count:
        sys.exit(f"{len(measured)} passes in {path}: expected {count}")
    speeds = [rpm for rpm, _, _ in measured]
    if min(speeds) > slowest * 1.02 or max(speeds) < fastest * 0.98:
        sys.exit(f"{min(speeds):.0f} to {max(speeds):.0f} rev/min: expected {slowest} to {fastest}")
    apart = (max(phases) - min(phases)) * 1e3
    if apart > 3:
        sys.exit(f"passes are {apart:.2f} um apart: expected 3 at most")
    print(f"{count} passes within {apart:.2f} um of one another")


def main():
    if sys.argv[1] == "threads":
        numbers = [float(word) for word in sys.argv[3:]]
        return threads(sys.argv[2], *numbers[:3], int(numbers[3]), *numbers[4:])
    path, taps = sys.argv[1], int(sys.argv[5])
    pitch, programmed, depth = (float(word) for word in sys.argv[2:5])
    table = rows(path)
    z, turns = [row[2] for row in table], [row[4] for row in table]
    found = [judge(z, turns, at, pitch, depth) for at in reversals(z, turns)]
    for number, tap in enumerate(found, 1):
        print(
            f"tap {number:2}: deepest {tap['deepest']:.4f} mm, off its helix {tap['error_um']:.1f} um at most, "
            f"between in and out {tap['shift_um']:+.1f} um, change of acceleration between periods "
            f"{tap['ripple']:.0f} mm/s2, {tap['seconds']:.3f} s"
        )
    if len(found) != taps:
        sys.exit(f"{len(found)} taps in {path}: expected {taps}")
    for number, tap in enumerate(found, 1):
        deeper = abs(tap["deepest"] - programmed) * 1e3
        if tap["error_um"] > 10 or abs(tap["shift_um"]) > 2 or deeper > 50:
            sys.exit(f"tap {number} is not good: {deeper:.1f} um from the programmed depth")
    print(f"{taps} taps are good")


if __name__ == "__main__":
    main()
