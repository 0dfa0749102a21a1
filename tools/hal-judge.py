#!/usr/bin/env python3
"""Judges taps and turned threads that halsampler has recorded in HAL.

hal-judge.py SAMPLES PITCH BOTTOM DEPTH TAPS
hal-judge.py threads SAMPLES PITCH FROM TO PASSES SLOWEST FASTEST
hal-judge.py oriented SAMPLES DEGREES[:TURNED]...
hal-judge.py times MHZ NAME TIMES [NAME TIMES...]
hal-judge.py beside OURS THEIRS PITCH START BOTTOM DEPTH TAPS

It knows nothing of who has commanded them. A tap is where the spindle turns back while Z stands deepest: on its thread
Z + PITCH * revolutions is a constant (right-hand, Z down), inward and outward the same one.

It fails unless there are TAPS of them, each within 10 um of its helix, within 2 um the same in and out, and within 50 um of BOTTOM.

A pass of a thread is where Z goes from FROM down to TO while the spindle turns forwards, PITCH a turn. Its phase is the mean of
Z + PITCH * revolutions there, of which whole pitches are left out. It fails unless there are PASSES of them, from SLOWEST to FASTEST
rev/min, within 3 um of one another.

Oriented: it fails unless the spindle stands at these angles within its turn, one after the other, each for a quarter of a second
and within 0.3 degrees, having TURNED so many degrees since the one before, where that is said.

Beside: the same program by two controls on the same plant, a row of a table for each tap. Between its arrival at START and its return
there Z goes down to BOTTOM, and what is judged is the travel within DEPTH of BOTTOM. Ripple is what Z's acceleration changes by from
one period to the next, as much as 99 of 100 periods stay below. OURS fails unless it has TAPS taps, by twos at the same speed: the
first of two not beyond BOTTOM (a count of the encoder is no depth), the second not by more than 50 um, each the same in and out
within 5 um, with a ripple of 20 mm/s2 at most, and none slower than the same one of THEIRS where that came out.

Times are those of a function of the servo thread in clocks of the processor, a row a period: it fails where there are fewer than
1000 of them.

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
    return {
        "deepest": min(z[first : last + 1]),
        "error_um": max(abs(value - middle) for value in line) * 1e3,
        "shift_um": (sum(inward) / len(inward) - sum(outward) / len(outward)) * 1e3,
        "ripple": ripple(z[first : last + 1]),
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


def oriented(path, degrees):
    turns = [row[4] for row in rows(path)]
    least, stands, at = int(0.25 / PERIOD), [], 0
    for k in range(1, len(turns) + 1):
        # a drive may creep on by some counts
        if k == len(turns) or abs(turns[k] - turns[at]) > 6 * COUNT:
            if k - at >= least:
                stands.append(turns[(at + k) // 2] * 360)
            at = k
    left, before = list(degrees), None
    for stand in stands:
        if not left:
            break
        to, _, turned = left[0].partition(":")
        if abs((stand - float(to) + 180) % 360 - 180) > 0.3:
            continue
        if turned and (before is None or abs(stand - before - float(turned)) > 0.6):
            continue
        came = "" if before is None else f", {stand - before:+.2f} from where it stood before"
        print(f"the spindle stands at {stand % 360:.2f} degrees{came}: {left.pop(0)} was ordered")
        before = stand
    if left:
        sys.exit(f"the spindle has not stood at {left[0]} degrees in {path}: only at {[round(stand, 2) for stand in stands]}")


COUNT = 1 / 4096  # revolution


def ripple(z):
    """Of Z's acceleration from one period to the next, mm/s2: the value that 99 of 100 stay below."""
    second = [(z[k + 1] - 2 * z[k] + z[k - 1]) / PERIOD**2 for k in range(1, len(z) - 1)]
    changes = sorted(abs(b - a) for a, b in zip(second, second[1:]))
    return changes[int(len(changes) * 0.99)]


def beside_taps(path, pitch, start, bottom, depth):
    """Each time that Z goes from START into the last DEPTH before BOTTOM: what it did there."""
    table = rows(path)
    z, turns = [row[2] for row in table], [row[4] for row in table]
    found, at = [], 0
    while at < len(z):
        if z[at] > start + 1e-3:
            at += 1
            continue
        arrived = at
        while at < len(z) and z[at] <= start + 1e-3:
            at += 1
        inside = [k for k in range(arrived, at) if z[k] <= bottom + depth]
        if not inside:
            continue
        turned = max(range(inside[0], inside[-1] + 1), key=lambda k: turns[k])
        inward = [z[k] + pitch * turns[k] for k in range(inside[0], turned)]
        outward = [z[k] + pitch * turns[k] for k in range(turned, inside[-1] + 1)]
        speeds = sorted(abs(turns[k + 50] - turns[k]) / 50 / PERIOD for k in range(inside[0], inside[-1] - 50))
        came_out = at < len(z) and len(inward) > 0
        found.append(
            {
                "rpm": speeds[int(0.95 * len(speeds))] * 60,
                "beyond": bottom - min(z[k] for k in inside),
                "shift": sum(inward) / len(inward) - sum(outward) / len(outward) if came_out else None,
                "ripple": ripple(z[inside[0] : inside[-1] + 1]) if came_out else None,
                "seconds": (at - arrived) * PERIOD if came_out else None,
            }
        )
    return found


def beside(ours, theirs, pitch, start, bottom, depth, count):
    tables = [beside_taps(path, pitch, start, bottom, depth) for path in (ours, theirs)]
    print("                 fastest    beyond the   between in     ripple")
    print("                 rev/min    bottom, mm   and out, mm   mm/s2     time, s")
    for number in range(max(map(len, tables))):
        for name, taps in zip(("Leadscrew", "LinuxCNC"), tables):
            if number >= len(taps):
                print(f"{number + 1}  {name:12}  -")
                continue
            tap = taps[number]
            line = f"{number + 1}  {name:12}{tap['rpm']:8.0f}  {tap['beyond']:+12.4f}"
            if tap["seconds"] is None:
                print(f"{line}   it does not come out")
            else:
                print(f"{line}  {tap['shift']:+12.4f}  {tap['ripple']:8.0f}  {tap['seconds']:10.3f}")
    mine, other = tables
    if len(mine) != count:
        sys.exit(f"{len(mine)} taps in {ours}: expected {count}")
    wrong = []
    for number, tap in enumerate(mine):
        of = f"tap {number + 1}"
        if tap["seconds"] is None:
            wrong.append(f"{of} does not come out")
            continue
        most = 0.05 if number % 2 else pitch * COUNT
        if tap["beyond"] > most:
            wrong.append(f"{of} is {tap['beyond']:.4f} mm beyond the bottom: expected {most:.4f} at most")
        if abs(tap["shift"]) > 0.005:
            wrong.append(f"{of} is shifted by {tap['shift']:.4f} mm between in and out: expected 0.005 at most")
        if tap["ripple"] > 20:
            wrong.append(f"{of} has a ripple of {tap['ripple']:.0f} mm/s2: expected 20 at most")
        theirs_took = other[number]["seconds"] if number < len(other) else None
        if theirs_took is not None and tap["seconds"] > theirs_took:
            wrong.append(f"{of} took {tap['seconds']:.3f} s: LinuxCNC took {theirs_took:.3f}")
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"{count} taps are as they should be")


def times(clocks_per_us, of):
    print("                      periods  mean, us  half, us  99.9 %, us  worst, us")
    for name, path in zip(of[::2], of[1::2]):
        took = sorted(int(line) / clocks_per_us for line in open(path) if line.strip().isdigit())
        if len(took) < 1000:
            sys.exit(f"{len(took)} times in {path}: expected 1000 at least")
        mean = sum(took) / len(took)
        half = took[len(took) // 2]
        print(f"{name:20}{len(took):9}{mean:10.2f}{half:10.2f}{took[int(len(took) * 0.999)]:12.1f}{took[-1]:11.1f}")


def main():
    if sys.argv[1] == "times":
        return times(float(sys.argv[2]), sys.argv[3:])
    if sys.argv[1] == "beside":
        numbers = [float(word) for word in sys.argv[4:]]
        return beside(sys.argv[2], sys.argv[3], *numbers[:4], int(numbers[4]))
    if sys.argv[1] == "oriented":
        return oriented(sys.argv[2], sys.argv[3:])
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
