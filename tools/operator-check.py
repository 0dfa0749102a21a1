#!/usr/bin/env python3
"""Holds the setpoints of runs in which an operator interferes against the machine's limits and the programmed path.

    python tools/operator-check.py                      each kind of path once, and the programs named behind it
    python tools/operator-check.py --runs 200 PART.ngc  at length, and a run of a program
    python tools/operator-check.py --within 0.9         shows that it finds what is wrong: it fails

Overrides, holds, single block and aborts come at random instants of the run. What is checked is the recorded setpoints alone, at a
servo period of 250 µs; nothing of the planner is used but the operations that the program means (``canon``):

    speed, acceleration, jerk   first, second, third differences of each axis, against its limits in the machine's file
    path                        distance of every setpoint to the programmed lines and arcs, against P
    end                         the last setpoint is the programmed end, unless the operator has given up

It needs the Python package, numpy and scipy.
"""

from __future__ import annotations

import argparse
import itertools
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import leadscrew
import numpy as np
from scipy.spatial import cKDTree

PERIOD_US = 250
AXES = "XYZ"
#: Share by which a difference may be above its limit: the stretching of time by an override is held to these.
ROOM = {"speed": 0.001, "acceleration": 0.01, "jerk": 0.05}
#: Setpoints are recorded to this, mm; third differences are taken over 1 ms, where it hardly shows.
RESOLUTION_MM = 2.0**-26
STRIDE = {"speed": 1, "acceleration": 1, "jerk": 4}
#: Beyond P: rounding of the programmed places, mm.
GRID_MM = 1e-4
#: Orders of one run, at most.
MOST_ORDERS = 6


def zigzag(rng: np.random.Generator) -> str:
    """Chords shorter than P between two lines side by side."""
    step, width, p = rng.uniform(0.02, 0.2), rng.uniform(0.01, 0.1), rng.choice([0.005, 0.02, 0.05])
    lines = [f"X{k * step:.4f} Y{width * (k % 2):.4f}" for k in range(1, 400)]
    return f"G64 P{p}\nF{rng.integers(1000, 8000)}\n" + "\n".join(f"G1 {line}" for line in lines)


def surface(rng: np.random.Generator) -> str:
    """Rows over a wavy surface."""
    step, p = rng.uniform(0.1, 0.6), rng.choice([0.002, 0.01, 0.1])
    rows = []
    for row in range(4):
        xs = np.arange(0, 30, step)[:: 1 if row % 2 == 0 else -1]
        rows += [f"G1 X{x:.4f} Y{0.5 * row:.4f} Z{math.sin(x / 3) + 0.3 * math.sin(2.1 * x + row):.4f}" for x in xs]
    return f"G64 P{p}\nF{rng.integers(2000, 8000)}\n" + "\n".join(rows)


def trochoid(rng: np.random.Generator) -> str:
    """Circles that move along."""
    radius, step = rng.uniform(0.5, 4), rng.uniform(0.1, 0.6)
    circles = [f"G3 X{k * step:.4f} Y0 I{step / 2:.5f} J{-radius:.4f}" for k in range(1, 40)]
    return f"G64 P0.02\nF{rng.integers(2000, 6000)}\n" + "\n".join(circles)


def mixed(rng: np.random.Generator) -> str:
    """Lines of all lengths, corners of all angles, rapids and changes of mode between them."""
    at, lines = np.zeros(3), []
    for k in range(120):
        at = at + rng.normal(size=3) * 10 ** rng.uniform(-2, 1)
        at = np.clip(at, -60, 60)
        if k % 30 == 0:
            lines.append(rng.choice(["G61", "G61.1", "G64 P0.01", "G64 P0.3 Q0.005"]))
        code = "G0" if rng.random() < 0.1 else "G1"
        lines.append(f"{code} X{at[0]:.4f} Y{at[1]:.4f} Z{at[2]:.4f}")
    return f"G64 P0.05\nF{rng.integers(500, 12000)}\n" + "\n".join(lines)


PATHS = {kind.__name__: kind for kind in (zigzag, surface, trochoid, mixed)}


def orders(rng: np.random.Generator, planned_s: float) -> str:
    """What the operator does, and when."""
    said, at = [], 0.0
    for _ in range(rng.integers(1, MOST_ORDERS + 1)):
        at += rng.uniform(0.02, 0.5) * planned_s
        match rng.choice(["hold", "override", "rapid", "single", "abort"], p=[0.35, 0.35, 0.15, 0.1, 0.05]):
            case "hold":
                said.append(f"hold at {at:.4f}s")
                at += rng.choice([0.001, 0.05, 0.3])
                said.append(f"resume at {at:.4f}s")
            case "override":
                said.append(f"override {rng.choice([0, 1, 20, 50, 90, 120, 150, 200])} at {at:.4f}s")
            case "rapid":
                said.append(f"rapid-override {rng.choice([25, 50, 100])} at {at:.4f}s")
            case "single":
                said.append(f"single-block on at {at:.4f}s")
                at += 0.2
                said += [f"single-block off at {at:.4f}s", f"resume at {at + 0.01:.4f}s"]
            case "abort":
                said.append(f"abort at {at:.4f}s")
                break
    # whatever stands still goes on
    said += [f"override 100 at {at + 1:.4f}s", f"resume at {at + 1.1:.4f}s"]
    return "; ".join(said)


@dataclass
class Limits:
    """Of each axis, mm and s; infinite where there is none."""

    speed: np.ndarray
    acceleration: np.ndarray
    jerk: np.ndarray

    @staticmethod
    def of(machine: leadscrew.Machine, within: float) -> Limits:
        """By its file: the larger of feed and rapid, and a share of it."""
        keys = [f"axes.{axis.lower()}." for axis in AXES]
        stated = [[machine[f"{key}jerk_{kind}_m_per_s3"] for kind in ("feed", "rapid")] for key in keys]
        jerks = [[math.inf if value == "unlimited" else value for value in both] for both in stated]
        return Limits(
            within * np.array([machine[f"{key}rapid_mm_per_min"] / 60 for key in keys]),
            within * np.array([machine[f"{key}acceleration_m_per_s2"] * 1e3 for key in keys]),
            within * np.array([max(both) * 1e3 for both in jerks]),
        )


class Programmed:
    """Where the program leads, as points so close that the distance to the nearest is that to the path; with P of each."""

    def __init__(self, operations: list[dict], within: float) -> None:
        at, p, self.ends = np.zeros(3), 0.0, np.zeros(3)
        points, allowed = [at[None]], [np.zeros(1)]
        lines = []
        for op in operations:
            if op["op"] == "path-mode":
                if op["mode"] == "blend" and op["tolerance_mm"] is None:
                    raise SystemExit("G64 without P leaves nothing to hold a path against: write G64 P0.01")
                p = op["tolerance_mm"] * within if op["mode"] == "blend" else 0.0
            if "to_mm" not in op:
                continue
            to = np.array([op["to_mm"].get(axis, at[k]) for k, axis in enumerate(AXES)])
            lines.append((at, to, op, p))
            at = to
        # a corner belongs to the block before it and the one behind it
        for k, (start, to, op, p) in enumerate(lines):
            near = max(p, lines[k + 1][3] if k + 1 < len(lines) else 0.0, lines[k - 1][3] if k else 0.0)
            way = self._way(start, to, op, spacing_mm(near))
            points.append(way)
            allowed.append(np.full(len(way), near))
        self.ends = at
        every, of = np.concatenate(points), np.concatenate(allowed)
        self.trees = [(p, cKDTree(every[of == p])) for p in np.unique(of)]

    @staticmethod
    def _way(start: np.ndarray, to: np.ndarray, op: dict, spacing: float) -> np.ndarray:
        if op["op"] == "arc":
            first, second = (AXES.index(axis) for axis in {"XY": "XY", "XZ": "ZX", "YZ": "YZ"}[op["plane"]])
            centre = np.array(op["centre_mm"])
            arm = np.array([start[first], start[second]]) - centre
            sweep = math.radians(op["sweep_deg"])
            n = max(2, math.ceil(abs(sweep) * np.hypot(*arm) / spacing) + 1)
            turned = np.linspace(0, sweep, n)
            way = start + np.linspace(0, 1, n)[:, None] * (to - start)
            end_arm = np.array([to[first], to[second]]) - centre
            radius = np.linspace(np.hypot(*arm), np.hypot(*end_arm), n)
            angle = math.atan2(arm[1], arm[0]) + turned
            way[:, first], way[:, second] = centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)
            return way
        n = max(2, math.ceil(np.linalg.norm(to - start) / spacing) + 1)
        return start + np.linspace(0, 1, n)[:, None] * (to - start)

    def beyond(self, places: np.ndarray) -> tuple[float, int]:
        """The largest distance beyond P, mm, and where."""
        over = np.full(len(places), np.inf)
        for p, tree in self.trees:
            distance, _ = tree.query(places)
            # half a spacing along the path is no distance from it
            across = np.sqrt(np.maximum(distance**2 - (spacing_mm(p) / 2) ** 2, 0))
            over = np.minimum(over, across - p - GRID_MM)
        worst = int(np.argmax(over))
        return float(over[worst]), worst


def spacing_mm(p: float) -> float:
    """Of the points that stand for a path with this P."""
    return max(0.2 * p, 2e-3)


def wrong_with(text: str, said: str, machine: leadscrew.Machine, limits: Limits, planned: Programmed) -> list[str]:
    """Everything that a run shows."""
    result = leadscrew.run("part.ngc", text=text, machine=machine, operator=said, missing_tools="stand-in", trace=True)
    trace = result.trace
    assert trace is not None
    places = np.stack([np.asarray(trace[f"{axis.lower()}_control_setpoint_mm"]) for axis in AXES], axis=1)
    # before its first block the setpoint follows what the brakes let go of
    places = places[int(np.argmax(np.asarray(trace["line"]) > 0)) :]
    dt = PERIOD_US * 1e-6
    found = []
    for order, name in enumerate(ROOM, 1):
        stride = STRIDE[name]
        rate = places
        for _ in range(order):
            rate = (rate[stride:] - rate[:-stride]) / (stride * dt)
        rounding = 2**order * RESOLUTION_MM / 2 / (stride * dt) ** order
        over = (np.abs(rate) - rounding) / getattr(limits, name)
        at, axis = np.unravel_index(int(np.argmax(over)), over.shape)
        if over[at, axis] > 1 + ROOM[name]:
            found.append(f"{name} of {AXES[axis]} is {over[at, axis]:.3f} of its limit at {at * dt:.4f} s")
    over, at = planned.beyond(places)
    if over > 0:
        found.append(f"{over * 1e3:.2f} µm beyond P at {at * dt:.4f} s, {places[at].round(4)}")
    off = np.abs(places[-1] - planned.ends).max()
    if "abort" not in said and off > 1e-6:
        found.append(f"ends {off:.6f} mm beside its end; ending {result.ending}")
    return found


def main() -> int:
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("programs", nargs="*", type=Path)
    asked.add_argument("--machine", action="append", help="[default: bench-xyz and bench-xyz-jerk20]")
    asked.add_argument("--runs", type=int, default=4, help="of each machine on the kinds of path in turn")
    asked.add_argument("--seed", type=int, default=1)
    asked.add_argument("--within", type=float, default=1.0, help="share of limits and P that is allowed")
    args = asked.parse_args()
    failed = ran = 0
    for name in args.machine or ["bench-xyz", "bench-xyz-jerk20"]:
        machine = leadscrew.Machine.load(name).with_({"control.period_us": PERIOD_US})
        limits = Limits.of(machine, args.within)
        for run, source in enumerate([*itertools.islice(itertools.cycle(PATHS), args.runs), *args.programs]):
            rng = np.random.default_rng([args.seed, run])
            body = PATHS[source](rng) if isinstance(source, str) else None
            text = f"G21 G90 G17 G40 G49 G94\nG0 X0 Y0 Z0\n{body}\nM2\n" if body else Path(source).read_text()
            options = {"text": text, "machine": machine, "missing_tools": "stand-in"}
            said = orders(rng, leadscrew.time("part.ngc", **options)["motion_time_s"])
            found = wrong_with(text, said, machine, limits, Programmed(leadscrew.canon("part.ngc", **options), args.within))
            ran += 1
            for why in found:
                print(f"{name}, seed {args.seed}, run {run}, {source}: {why}\n    operator: {said}", flush=True)
            failed += bool(found)
            if sys.stderr.isatty():
                print(f"\r{ran} runs, {failed} of them wrong", end="", file=sys.stderr)
    print(f"{ran} runs, {ran - failed} of them within limits, within P, and at their end")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
