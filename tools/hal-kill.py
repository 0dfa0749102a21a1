#!/usr/bin/env python3
"""Stops a tap on the simulated mill of HAL at many instants, and judges what became of the tool.

hal-kill.py LEADSCREW MACHINE SAMPLES COUNT SEED

`tools/hal kill [COUNT]` runs it within a HAL session. Each round a control taps, and is stopped within the hole: by an abort, by
SIGKILL of the control, by unloading the component, or by a feed hold that is gone on from, in turn. Then a control takes the machine
over: it takes the tool out, or says why it does not. It knows nothing of Leadscrew but its pins, its scripts and what it prints; how far the tool was off its helix is
taken from what halsampler has recorded in HAL, from the first thread in the work until it is out, or stands.

It fails if a tool left its helix by more than 20 um in the work, if one that stands in the work is neither taken out nor refused with a
reason, or if a control says that it is out and it is not.
"""
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

# where the state is: what is tried is a control that dies, not a disk that is slow because others write to it
MEMORY = "/dev/shm"
LEAD = 1.0  # mm a turn
SURFACE = -194.75  # machine Z of the work's surface for the tip
OFF = 20e-3  # mm
NOT_BEGUN = "no tap began\n"  # a computer that is busy has lost the connection before
WAYS = ["abort", "kill", "unload", "hold"]
# what record.hal and mill.hal wire of the component: loaded again, it has new pins
WIRES = [
    ("chain-ok", "estop-ok"), ("x-fb", "x.pos-fb"), ("y-fb", "y.pos-fb"), ("z-fb", "z.pos-fb"), ("angle", "spindle.0.revs"),
    ("change-tool", "tool-change tool-changed"), ("x-cmd", "x.pos-cmd"), ("y-cmd", "y.pos-cmd"), ("z-cmd", "z.pos-cmd"),
    ("speed-cmd", "spindle.0.speed-cmd-rps"), ("state", "state"), ("sync-error", "sync-error"),
]
TAP = """G21 G17 G90 G54
T3 M6
G43 H3
S1000 M3
G0 X12 Y12 Z30
G99 G84 X12 Y12 Z-20 R5 F1000
G80
G0 Z50
M5
M30
"""
BEGIN = "power on\nwait ready within 20 s\nhome\nwait homed within 30 s\nwait standstill within 30 s\n"


def hal(*words):
    answer = subprocess.run(["halcmd", *words], capture_output=True, text=True)
    if answer.returncode:
        sys.exit(f"halcmd {' '.join(words)}: {answer.stderr or answer.stdout}")
    return answer.stdout.strip()


def signal_of(name):
    return float(hal("gets", name))


def until(what, limit):
    end = time.monotonic() + limit
    while time.monotonic() < end:
        if what():
            return True
        time.sleep(0.002)
    return False

class Mill:
    def __init__(self, leadscrew, machine, samples, folder):
        self.leadscrew, self.machine, self.samples, self.folder = leadscrew, machine, samples, folder
        self.state = f"{folder}/state"
        self.rows = 0
        self.recorded = open(samples)
        self.program = f"{folder}/tap.ngc"
        with open(self.program, "w") as file:
            file.write(TAP)

    def control(self, script):
        """A control that is led by these lines."""
        name = f"{self.folder}/script"
        words = [self.leadscrew, "control", "--drives", "hal", "--machine", self.machine, "--state", self.state]
        with open(name, "w") as file:
            file.write(script)
        return subprocess.Popen(
            words + ["--script", name], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )

    def led(self, script, limit=120):
        control = self.control(script)
        try:
            return control.communicate(timeout=limit)[0]
        except subprocess.TimeoutExpired:
            control.kill()
            sys.exit(f"a control has not ended within {limit} s:\n{script}\n{control.communicate()[0]}")

    def taken(self):
        """Rows since the last time: Z and revolutions. halsampler writes them a little late."""
        time.sleep(0.5)
        found = []
        while True:
            at = self.recorded.tell()
            line = self.recorded.readline()
            if not line.endswith("\n"):
                self.recorded.seek(at)
                return found
            fields = line.split()
            if len(fields) == 8:
                found.append((float(fields[2]), float(fields[4])))
            elif "overrun" in line:
                sys.exit("halsampler has lost rows")

    def load_again(self):
        hal("loadrt", "leadscrew", "axes=XYZ", "spindles=1", "din=4", "dout=4", "name=default")
        # what drives are told is where they are before they hear of it
        hal("addf", "leadscrew.update", "servo-thread", "1")
        for wire, pins in WIRES:
            hal("net", wire, *[f"leadscrew.{pin}" for pin in pins.split()])
            time.sleep(0.01)


def off_helix(rows):
    """How far the tool was off its helix from a thread below the surface until it is out or stands; None: it was not in."""
    line, still, before = [], 0, None
    for row in rows:
        if row[0] >= SURFACE - LEAD:
            if line:
                break
            continue
        still = still + 1 if row == before else 0
        before = row
        line.append(row[0] + LEAD * row[1])
        if still > 2000:
            break
    return (max(line) - min(line)) / 2 if line else None


def stopped(mill, way, after):
    """A tap that is stopped so, that long after it began; what its control has said."""
    script = f"{BEGIN}load {mill.program}\nstart\n"
    in_work = f"{script}wait tool in work within 60 s\nwait {0.4 + after:.3f} s\n"
    if way == "abort":
        ends = "wait 2 s\nretract\nwait tool out within 60 s\nwait standstill within 60 s\npower off\n"
        control = mill.control(in_work + "stop\nwait held within 20 s\n" + ends)
    elif way == "hold":
        ends = "wait 1 s\nresume\nwait completed within 60 s\nwait standstill within 20 s\npower off\n"
        control = mill.control(in_work + "hold\nwait held within 20 s\n" + ends)
    else:
        control = mill.control(script + "wait completed within 20 s\n")
    if not until(lambda: signal_of("z-fb") < SURFACE - LEAD, 60):
        control.kill()
        return NOT_BEGUN + control.communicate()[0]
    if way == "kill":
        time.sleep(after)
        control.send_signal(signal.SIGKILL)
    elif way == "unload":
        time.sleep(after)
        hal("unloadrt", "leadscrew")
        comes_to_rest()
        control.send_signal(signal.SIGTERM)  # it has no machine any more
    try:
        return control.communicate(timeout=180)[0]
    except subprocess.TimeoutExpired:
        control.kill()
        sys.exit(f"{way}: the control hangs: {control.communicate()[0]}")


def comes_to_rest():
    """Spindle and Z stand, by their encoders."""
    end = time.monotonic() + 30
    before, still = None, 0
    while still < 50:
        place = (signal_of("z-fb"), signal_of("angle"))
        still = still + 1 if place == before else 0
        before = place
        if time.monotonic() > end:
            sys.exit("the machine does not come to rest")


def one(mill, way, after):
    """A round: how far off the helix in mm, how deep it stood, what became of it, why, and all that was said."""
    mill.taken()
    said = stopped(mill, way, after)
    comes_to_rest()
    if said.startswith(NOT_BEGUN):
        return 0.0, 0.0, "not begun", "", said
    rows = mill.taken()
    error, depth = off_helix(rows) or 0.0, SURFACE - rows[-1][0]
    if way == "unload":
        mill.load_again()
    if "the tap is out of its hole" in said:
        return error, depth, "retracted", "", said
    if way == "hold" and "PROGRAM_COMPLETED" in said:
        return error, depth, "gone on with", "", said
    found = mill.led("recover\nwait tool out within 120 s\npower off\n")
    error = max(error, off_helix(mill.taken()) or 0.0)
    is_out = signal_of("z-fb") > SURFACE
    if is_out and "the tool is out of the work" in found:
        return error, depth, "recovered", "", said + found
    if is_out and "no tap stands in a thread" in found:
        return error, depth, "out by itself", "", said + found
    why = re.findall(r"refused: (.*)|^error: (.*)", found, re.M)
    # by hand, as the operator has to
    mill.led(f"tool is free\n{BEGIN}jog Z to 0\nwait standstill within 60 s\npower off\n")
    return error, depth, "refused" if why else "left and nothing said", "".join(why[0]) if why else "", said + found


def main():
    leadscrew, machine, samples = sys.argv[1:4]
    count, seed = int(sys.argv[4]), int(sys.argv[5])
    chance = random.Random(seed)
    tally, far, bad = {}, 0, 0
    with tempfile.TemporaryDirectory(dir=MEMORY if os.path.isdir(MEMORY) else None) as folder:
        mill = Mill(leadscrew, machine, samples, folder)
        for number in range(count):
            way = WAYS[number % len(WAYS)]
            error, depth, what, why, said = one(mill, way, chance.uniform(0.0, 2.2))
            where = f"{depth:6.3f} mm deep" if depth > LEAD else "out of its hole"
            print(f"{number + 1:3} {way:6}: {where}, {error * 1e3:.1f} um off the helix at most, {what}{why and ': ' + why}", flush=True)
            tally[way, what] = tally.get((way, what), 0) + 1
            far += error > OFF
            if "nothing said" in what or error > OFF or what == "not begun":
                bad += 1
                print(said, flush=True)
    for (way, what), times in sorted(tally.items()):
        print(f"{way}: {times} {what}")
    print(f"{count} stopped: {far} off the helix by more than {OFF * 1e3:.0f} um, {bad} not as they should be")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
