#!/usr/bin/env python3
"""An operator's morning by the pins of a panel in HAL, and its judge.

hal-panel.py lead LEADSCREW MACHINE FOLDER
hal-panel.py judge SAMPLES

`tools/hal panel` runs both. Lead starts a control, loads a program into it, and does all else by `halcmd sets`, on the signals of
machines/hal/panel.hal: power, homing, a tool, X, Y and Z by the wheel, touching off, start, a hold and the way on, an override, a door
that is opened in the tap and closed again, power off.

Judge takes what halsampler has recorded, a row each millisecond: X Y Z Z-told revolutions rev/s-told state sync-error power-on home-all
touch-off cycle-start hold door wheel dial. It knows nothing of Leadscrew, and fails unless
- nothing has moved before the power was on, and while the operator let go of everything;
- the wheel has moved each axis by its counts, within 1 um;
- X stood from the hold to the next start, within its block, and the other axes with it;
- X went as fast as the program says, and after the dial was turned as the dial says, within 0.5 %;
- Z and the spindle stood while the door was open, in the work, and the whole tap is within 10 um of its helix, its bottom within 50 um.
"""
import os
import subprocess
import sys
import time

LEAD = 1.0  # mm a turn
WHEEL = {"x": -600, "y": -400, "z": -300}  # counts
COUNT = 0.1  # mm
ABOVE = 20.0  # mm over the surface, where Z is touched off
DEPTH = 20.0  # mm
FEED = 20.0  # mm/s
DIAL = -50  # %
PROGRAM = f"""G21 G17 G90 G54
T3 M6
G43 H3
S1000 M3
G1 X30 F{FEED * 60:.0f}
G1 X0
G1 X1
G99 G84 X10 Y5 Z-{DEPTH:.0f} R5 F1000
G80
G0 Z{ABOVE:.0f}
M5
M30
"""
LIMIT = 60  # s, that anything may take on a busy computer


def hal(*words):
    answer = subprocess.run(["halcmd", *words], capture_output=True, text=True)
    if answer.returncode:
        sys.exit(f"halcmd {' '.join(words)}: {answer.stderr or answer.stdout}")
    return answer.stdout.strip()


def place(name):
    return float(hal("gets", name))


def until(what, is_so):
    end = time.monotonic() + LIMIT
    while not is_so():
        if time.monotonic() > end:
            sys.exit(f"{what}: not within {LIMIT} s")
        time.sleep(0.002)


def press(key):
    for value in ("1", "0"):
        hal("sets", key, value)
        time.sleep(0.15)


def rest(axes="xyz"):
    """Waits until these axes stand."""
    before = [None]

    def is_so():
        now = [place(f"{axis}-fb") for axis in axes]
        time.sleep(0.1)
        stands, before[0] = now == before[0], now
        return stands

    until("the axes come to rest", is_so)


def morning():
    until("a control leads the machine", lambda: hal("getp", "leadscrew.connected") == "TRUE")
    time.sleep(0.5)
    press("power-on")
    until("drives have power", lambda: hal("getp", "leadscrew.x.enable") == "TRUE")
    press("home-all")
    time.sleep(0.5)
    rest()
    press("tool")
    until("the tool is there", lambda: hal("getp", "leadscrew.tool-number") == "3")
    rest()
    turned = 0
    for axis, counts in WHEEL.items():
        hal("sets", "wheel", str(turned := turned + 50))  # for no axis
        began = place(f"{axis}-fb")
        hal("sets", f"wheel-{axis}", "1")
        for _ in range(20):
            hal("sets", "wheel", str(turned := turned + counts // 20))
            time.sleep(0.02)
        until(f"{axis} has gone by the wheel", lambda: abs(place(f"{axis}-fb") - began - counts * COUNT) < 1e-3)
        hal("sets", f"wheel-{axis}", "0")
    rest()
    press("touch-off")
    time.sleep(0.5)
    began, surface = place("x-fb"), place("z-fb") - ABOVE
    press("cycle-start")
    until("X is in its first block", lambda: place("x-fb") > began + 8)
    hal("sets", "hold-key", "1")
    rest("x")
    time.sleep(0.5)
    hal("sets", "hold-key", "0")
    time.sleep(0.1)
    press("cycle-start")
    until("X is in its first block again", lambda: place("x-fb") > began + 28)
    until("X is in its second block", lambda: place("x-fb") < began + 22)
    hal("sets", "feed-dial", str(DIAL))
    until("X is at the end of it", lambda: place("x-fb") < began + 0.5)
    hal("sets", "feed-dial", "0")
    until("the tap is in the work", lambda: place("z-fb") < surface - 6)
    hal("sets", "door", "1")
    rest("z")
    time.sleep(0.7)
    hal("sets", "door", "0")
    until("Z is back", lambda: place("z-fb") > surface + ABOVE - 1e-3)
    rest()
    until("the spindle stands", lambda: place("speed-cmd") == 0)
    time.sleep(1.5)
    press("power-off")
    until("the drives are off", lambda: hal("getp", "leadscrew.x.enable") == "FALSE")


def lead(leadscrew, machine, folder):
    program = f"{folder}/morning.ngc"
    with open(program, "w") as file:
        file.write(PROGRAM)
    script = f"{folder}/morning.script"
    with open(script, "w") as file:
        file.write(f"load {program}\nwait 600 s\n")
    control = subprocess.Popen(
        [leadscrew, "control", "--drives", "hal", "--machine", machine, "--state", f"{folder}/morning", "--script", script],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )
    failed = None
    try:
        morning()
    except SystemExit as why:
        failed = why
    control.terminate()
    try:
        said = control.communicate(timeout=20)[0]
    except subprocess.TimeoutExpired:
        control.kill()
        said = control.communicate()[0]
    if failed:
        print(said, flush=True)
        raise failed
    print(f"the panel has led {program}", flush=True)


class Recording:
    def __init__(self, path):
        table = [line.split() for line in open(path)]
        self.rows = [[float(field) for field in row] for row in table if len(row) == 16]
        names = "x y z told turns speed state error power home touch start hold door wheel dial".split()
        for at, name in enumerate(names):
            setattr(self, name, [row[at] for row in self.rows])

    def rises(self, name):
        column = getattr(self, name)
        return [at for at in range(1, len(column)) if column[at] > column[at - 1]]

    def falls(self, name):
        column = getattr(self, name)
        return [at for at in range(1, len(column)) if column[at] < column[at - 1]]

    def moved(self, first, last, axes="xyz"):
        return max(max(column[first:last]) - min(column[first:last]) for column in (getattr(self, axis) for axis in axes))


def stands(column, first, last):
    """Where a column stands still for the longest time between two rows: first and last row of it."""
    best, began = (first, first), first
    for at in range(first + 1, last):
        if abs(column[at] - column[at - 1]) > 1e-7:
            began = at
        if at - began > best[1] - best[0]:
            best = (began, at)
    return best


def speed(column, first, last):
    """The speed at which it went most of the time, mm/s: the median."""
    each = sorted(abs(column[at] - column[at - 1]) * 1e3 for at in range(first + 1, last))
    return each[len(each) // 2]


def judge(path):
    record = Recording(path)
    bad = []

    def expect(is_so, sentence):
        print(sentence)
        if not is_so:
            bad.append(sentence)

    power, touch = record.rises("power")[0], record.rises("touch")[0]
    starts = record.rises("start")
    if len(starts) != 2:
        sys.exit(f"{len(starts)} starts in {path}: expected 2")
    moved = record.moved(0, power)
    expect(moved < 1e-6, f"before the power was on the axes moved by {moved * 1e3:.3f} um")
    wheel = record.rises("wheel")[0]
    for axis, counts in WHEEL.items():
        column = getattr(record, axis)
        by = column[touch] - column[wheel]
        expect(abs(by - counts * COUNT) < 1e-3, f"the wheel's {counts} counts moved {axis.upper()} by {by:.4f} mm")
    moved = record.moved(touch, starts[0])
    expect(moved < 1e-6, f"from touching off to the start the axes moved by {moved * 1e3:.3f} um")

    began, surface = record.x[touch], record.z[touch] - ABOVE
    hold = record.rises("hold")[0]
    first, last = stands(record.x, hold, starts[1])
    along = record.x[first] - began
    expect(
        0 < along < 30 and last >= starts[1] - 1,
        f"held at X{along:.3f} of the block, {(first - hold)} ms and {record.x[first] - record.x[hold]:.3f} mm after the key, until the start",
    )
    moved = record.moved(hold, starts[1], "yz")
    expect(moved < 1e-6, f"meanwhile Y and Z moved by {moved * 1e3:.3f} um")

    turned, back = record.falls("dial")[0], record.rises("dial")[0]
    top = max(range(starts[1], turned), key=lambda at: record.x[at])
    planned, slowed = speed(record.x, top, turned), speed(record.x, turned, back)
    expect(abs(planned / FEED - 1) < 5e-3, f"X went at {planned * 60:.1f} mm/min, {FEED * 60:.0f} by the program")
    share = 1 + DIAL / 100
    expect(abs(slowed / FEED / share - 1) < 5e-3, f"and at {slowed * 60:.1f} mm/min with the dial at {share * 100:.0f} %")

    opened, closed = record.rises("door")[0], record.falls("door")[0]
    first, last = stands(record.z, opened, closed)
    turns = max(record.turns[first:last]) - min(record.turns[first:last])
    expect(
        last - first > 500 and record.z[first] < surface and turns < 0.01,
        f"the door was opened {surface - record.z[opened]:.2f} mm deep: Z stood after {first - opened} ms, the spindle with it ({turns * 360:.2f} deg)",
    )
    inside = [at for at in range(starts[1], len(record.z)) if record.z[at] < surface]
    line = [record.z[at] + LEAD * record.turns[at] for at in inside]
    off = (max(line) - min(line)) / 2
    expect(off < 10e-3, f"the tap was no further than {off * 1e3:.1f} um off its helix")
    deepest = surface - min(record.z[at] for at in inside)
    expect(abs(deepest - DEPTH) < 50e-3, f"and {deepest:.3f} mm deep, {DEPTH:.0f} by the program")
    if bad:
        sys.exit("not as it should be:\n" + "\n".join(bad))


if __name__ == "__main__":
    if sys.argv[1:2] == ["lead"] and len(sys.argv) == 5:
        os.makedirs(sys.argv[4], exist_ok=True)
        lead(*sys.argv[2:])
    elif sys.argv[1:2] == ["judge"] and len(sys.argv) == 3:
        judge(sys.argv[2])
    else:
        sys.exit(__doc__)
