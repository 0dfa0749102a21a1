#!/usr/bin/env python3
"""Compares the judge's verdicts with an own picture of the workpiece, over random programs.

stock-check.py LEADSCREW TOOLS [COUNT [FIRST_SEED]]

Each program does five things (and what they need before) to one block, near to one another on purpose: a hole, a
counterbore, a tapped hole, a pocket, a slot. What is left is a field of depths over X and Y in cells of 0.1 mm, cut here
by tool after tool as the program orders it. A thread is a ring between its largest bore and its nominal diameter: at each
level of 0.1 mm it is there where nine tenths of its cells are.

  must not pass   half of the ordered length is gone, or more than three pitches were taken after it was tapped, or no hole
                  was drilled before; a hole that another one breaks into by 0.2 mm and more
  must pass       nothing of it was taken afterwards, and four fifths of the ordered length and a diameter are there;
                  a hole that no other comes nearer to than 0.2 mm
  between         no claim

A program that is refused before motion passes nothing, and is counted apart. It fails at the first contradiction of either
kind. TOOLS is the shipped table; three mills are added to it.
"""
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np

CELL = 0.1
SIZE = 60.0
STEP = 0.1
HEIGHT = 40.0
MILLS = {51: 5.0, 52: 12.0}
# thread: tap, drill, nominal, largest bore (6H), pitch, chamfer
THREADS = {"M6": (3, 2, 6.0, 5.153, 1.0), "M8": (11, 10, 8.0, 6.912, 1.25), "M10": (7, 5, 10.0, 8.676, 1.5)}
DRILLS = {2: (5.0, 140.0), 10: (6.8, 140.0), 5: (8.5, 140.0)}


class Block:
    """Depths below the top, and what was tapped."""

    def __init__(self):
        count = int(SIZE / CELL)
        centres = (np.arange(count) + 0.5) * CELL
        self.x, self.y = np.meshgrid(centres, centres, indexing="ij")
        self.depth = np.zeros((count, count))

    def off(self, x, y):
        return np.hypot(self.x - x, self.y - y)

    def cut(self, mask, depth):
        self.depth[mask] = np.maximum(self.depth[mask], depth)

    def drill(self, x, y, diameter, depth, angle=None):
        r = self.off(x, y)
        rise = 0.0 if angle is None else r / np.tan(np.radians(angle / 2))
        within = r <= diameter / 2
        self.depth = np.where(within, np.maximum(self.depth, depth - rise), self.depth)

    def along(self, a, b, diameter, depth):
        (ax, ay), (bx, by) = a, b
        dx, dy = bx - ax, by - ay
        length = dx * dx + dy * dy
        t = np.clip(((self.x - ax) * dx + (self.y - ay) * dy) / (length or 1.0), 0.0, 1.0)
        self.cut(np.hypot(self.x - ax - t * dx, self.y - ay - t * dy) <= diameter / 2, depth)

    def levels(self, x, y, inner, outer, down, share=0.9):
        """Levels of a thread's ring that are there, as a row of truths from the top down."""
        r = self.off(x, y)
        beyond = CELL if share > 0.9 else -CELL / 2
        ring = self.depth[(r > inner / 2 + CELL) & (r < outer / 2 + beyond)]
        return np.array([np.mean(ring <= level + 1e-9) >= share for level in np.arange(0.0, down, STEP)])


def program(rng):
    """A random program: its text, and what there is to be said of each hole and thread, by its line."""
    lines = ["G21 G17 G40 G49 G80 G90 G94 G54"]
    block, threads, holes, places = Block(), [], [], []

    def place():
        if places and rng.random() < 0.6:
            x, y = rng.choice(places)
            far = rng.choice([0.0, 1.5, 3.0, 5.0, 7.0, 8.5, 12.0])
            angle = rng.uniform(0, 2 * np.pi)
            x, y = x + far * np.cos(angle), y + far * np.sin(angle)
        else:
            x, y = rng.uniform(12, 48), rng.uniform(12, 48)
        at = round(min(max(x, 9), 51), 3), round(min(max(y, 9), 51), 3)
        places.append(at)
        return at

    def call(tool, speed):
        lines.extend([f"T{tool} M6", f"G43 H{tool}", f"S{speed} M3"])

    def cycle(tool, x, y, depth):
        call(tool, 3000)
        lines.extend([f"G0 X{x} Y{y} Z10", f"G98 G81 X{x} Y{y} Z-{depth} R2 F600", "G80"])
        diameter, angle = DRILLS.get(tool) or (MILLS[tool], None)
        full = depth - (0.0 if angle is None else diameter / 2 / np.tan(np.radians(angle / 2)))
        there = (block.depth < depth - 0.2)[block.off(x, y) <= diameter / 2 - CELL]
        holes.append({"line": len(lines) - 1, "at": (x, y), "d": diameter, "full": full, "cuts": bool(there.any())})
        block.drill(x, y, diameter, depth, angle)

    def hole():
        x, y = place()
        cycle(rng.choice(list(DRILLS)), x, y, rng.choice([8, 12, 20, 26]))

    def counterbore():
        x, y = place()
        cycle(52, x, y, rng.choice([1, 2, 5, 10]))

    def tapped():
        tap, drill, nominal, bore, pitch = THREADS[rng.choice(list(THREADS))]
        x, y = place()
        depth = rng.choice([12, 15, 18])
        drilled = rng.random() < 0.92
        if drilled:
            cycle(drill, x, y, depth + 8)
        between = rng.choice([None, None, None, counterbore, hole, pocket, slot])
        if between:
            between()
        call(tap, 600)
        lines.extend([f"G0 X{x} Y{y} Z10", f"G98 G84 X{x} Y{y} Z-{depth} R5 F{600 * pitch}", "G80"])
        full = depth - 2.5 * pitch
        r = block.off(x, y)
        is_open = block.depth[r < bore / 2 - 2 * CELL].min() >= depth - 0.2
        threads.append({
            "line": len(lines) - 1, "at": (x, y), "ring": (bore, nominal), "pitch": pitch, "full": full,
            "seen": drilled and is_open, "before": block.levels(x, y, bore, nominal, full),
            "whole": block.levels(x, y, bore, nominal, full, 0.995),
            # what is wider than the bore at the tap's own place
            "over": [t for t in threads if np.hypot(t["at"][0] - x, t["at"][1] - y) < (t["ring"][1] + nominal) / 2],
        })
        for other in threads[-1]["over"]:
            other["tapped over"] = True
        block.drill(x, y, bore, min(depth, block.depth[r < bore / 2 - 2 * CELL].min()))

    def slot():
        (x, y), tool, depth = place(), rng.choice(list(MILLS)), rng.choice([1, 3, 6])
        to = (round(min(max(x + rng.uniform(-20, 20), 9), 51), 3), y)
        call(tool, 4000)
        lines.extend([f"G0 X{x} Y{y} Z10", "G0 Z2", f"G1 Z-{depth} F1500", f"G1 X{to[0]} Y{to[1]}", "G0 Z10"])
        block.along((x, y), to, MILLS[tool], depth)

    def pocket():
        (x, y), depth, off = place(), rng.choice([2, 5, 12]), 4.0
        call(52, 4000)
        lines.extend([
            f"G0 X{x} Y{y} Z10", "G0 Z2", f"G1 Z-{depth} F1500", f"G1 X{x + off:.3f}",
            f"G3 X{x + off:.3f} Y{y} I-{off} J0", f"G1 X{x}", "G0 Z10",
        ])
        block.cut(block.off(x, y) <= 10.0, depth)

    steps = [hole, counterbore, tapped, pocket, slot, tapped]
    rng.shuffle(steps)
    for step in steps[:5]:
        step()
    lines.extend(["G0 Z30", "M5", "M2"])
    return "\n".join(lines) + "\n", block, threads, holes


def of_thread(thread, block):
    """`False`: it must not pass, `True`: it must; `None`: no claim."""
    bore, nominal = thread["ring"]
    after = block.levels(*thread["at"], bore, nominal, thread["full"])
    left, taken = after.sum() * STEP, (thread["before"] & ~after).sum() * STEP
    if not thread["seen"] or left < 0.45 * thread["full"] or taken > 3 * thread["pitch"]:
        return False
    if thread["over"] or thread.get("tapped over"):
        return None
    whole = thread["whole"] & block.levels(*thread["at"], bore, nominal, thread["full"], 0.995)
    if (thread["whole"] & ~whole).any() or (thread["before"] & ~thread["whole"]).any():
        return None
    if taken == 0.0 and whole.sum() * STEP >= max(0.8 * thread["full"], nominal):
        return True
    return None


def of_hole(hole, holes, threads):
    if not hole["cuts"]:
        return None  # a hole in a hole, or in the air over a pocket
    gaps = []
    for other in [h for h in holes if h is not hole]:
        apart = np.hypot(hole["at"][0] - other["at"][0], hole["at"][1] - other["at"][1])
        small, large = sorted([hole["d"], other["d"]])
        if apart < 0.05 or apart + small / 2 < large / 2 - 0.2 or min(hole["full"], other["full"]) <= 0.3:
            continue
        gaps.append(apart - (small + large) / 2 if apart + small / 2 > large / 2 + 0.2 else None)
    for thread in threads:
        apart = np.hypot(hole["at"][0] - thread["at"][0], hole["at"][1] - thread["at"][1])
        if 0.05 < apart < (hole["d"] + thread["ring"][1]) / 2 + 0.2:
            gaps.append(None)
    known = [gap for gap in gaps if gap is not None]
    if any(gap < -0.2 for gap in known):
        return False
    return True if len(known) == len(gaps) and all(gap > 0.2 for gap in known) else None


def table(shipped):
    text = pathlib.Path(shipped).read_text()
    for number, diameter in MILLS.items():
        text += (
            f'\n[[tool]]\nnumber = {number}\nkind = "end-mill"\ndescription = "mill"\ndiameter_mm = {diameter}\n'
            'length_mm = 110.0\nform = "flat"\nteeth = 3\nstick_out_mm = 50\nmax_chip_mm = 1.0\nmax_depth_mm = 40\n'
        )
    return text


def main():
    leadscrew, tools = sys.argv[1:3]
    count, first = (int(n) for n in (sys.argv[3:] + ["100", "1"][len(sys.argv) - 3:])[:2])
    tally = {"refused": 0, "must not pass": 0, "must pass": 0, "no claim": 0}
    home = pathlib.Path(tempfile.mkdtemp())
    (home / "tools.toml").write_text(table(tools))
    wrong, reasons = 0, {}
    for seed in range(first, first + count):
        text, block, threads, holes = program(random.Random(seed))
        path = home / f"part-{seed}.ngc"
        path.write_text("(STOCK X0 Y0 Z-40 X60 Y60 Z0)\n" + text)
        ran = subprocess.run(
            [leadscrew, "run", path, "--machine", "tapping-center", "--tools", home / "tools.toml", "--format", "json"],
            capture_output=True, text=True,
        )
        found = json.loads(ran.stdout or "[]")
        if isinstance(found, list):
            tally["refused"] += 1
            continue
        judged = {f["line"]: f for f in found["features"] if f["kind"] in ("hole", "thread")}
        said = [(t["line"], of_thread(t, block)) for t in threads] + [(h["line"], of_hole(h, holes, threads)) for h in holes]
        for line, claim in said:
            feature = judged.get(line + 1, {"verdict": "missing"})
            tally[{None: "no claim", True: "must pass", False: "must not pass"}[claim]] += 1
            why = (feature.get("reason") or feature["verdict"])[:36]
            reasons[why] = reasons.get(why, 0) + 1
            if claim is not None and claim != (feature["verdict"] == "pass"):
                wrong += 1
                print(f"seed {seed} line {line + 1}: {feature['verdict']}, expected {claim}: {feature.get('reason')}\n  {path}")
    print(f"{count} programs: " + ", ".join(f"{n} {what}" for what, n in tally.items()) + f"; {wrong} contradictions")
    print(reasons)
    sys.exit(wrong > 0)


main()
