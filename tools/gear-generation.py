#!/usr/bin/env python3
"""Generates gears by an envelope of their own and measures them as a caliper and two balls would: what the judge's closed forms are
held against.

    python tools/gear-generation.py                                   ten gears against the closed forms, and the table of their sizes
    python tools/gear-generation.py CERTIFICATE TOOLS NUMBER          the gears of a certificate, cut by hob T NUMBER of a tool table

The rack is a polygon: two straight flanks and a rounded tip. It rolls on the work in small steps; what a ray of the work keeps is the
largest angle to which any step cuts it. Nothing here knows an involute. The span is the least distance of two parallel planes that
hold k teeth between them, over their tilt; a ball is let into a gap until it touches. Needs numpy; exits with 1 where a size is off by
more than 2 µm.
"""

from __future__ import annotations

import json
import math
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

WITHIN_MM = 2e-3
JAW = 0.7  # how far a jaw reaches below the middle of a flank, modules
RADII, HEIGHTS, ROLLS = 500, 601, 6001


@dataclass(frozen=True)
class Hob:
    module: float
    addendum: float
    tip_radius: float
    pressure_deg: float = 20.0


@dataclass(frozen=True)
class Gear:
    """Teeth, helix angle (degrees, positive: right hand), and x·m: how far the hob's datum line stands off the reference circle, mm."""

    hob: Hob
    teeth: int
    helix_deg: float
    off_mm: float
    starts: int = 1

    @property
    def reference(self) -> float:
        return self.hob.module * self.teeth / math.cos(math.radians(self.helix_deg)) / 2


def rack(gear: Gear) -> np.ndarray:
    """Half a tooth of the rack in the transverse section: along the pitch line from the tooth's middle, and towards the work."""
    hob, alpha = gear.hob, math.radians(gear.hob.pressure_deg)
    half, top = math.pi * hob.module / 4, hob.addendum
    rho = hob.tip_radius
    # the arc touches the flank and the crest
    centre_y = top - rho
    centre_x = half - centre_y * math.tan(alpha) - rho / math.cos(alpha)
    if centre_x < 0:
        raise SystemExit(f"a tip radius of {rho} mm does not fit the hob's tooth")
    turned = np.linspace(math.pi / 2, alpha, 400)
    arc = np.column_stack([centre_x + rho * np.cos(turned), centre_y + rho * np.sin(turned)])
    crest = np.column_stack([np.linspace(0, centre_x, 20, endpoint=False), np.full(20, top)])
    flank_y = np.linspace(arc[-1, 1], -2.0 * hob.module, 3000)[1:]
    flank = np.column_stack([half - flank_y * math.tan(alpha), flank_y])
    normal = np.vstack([crest, arc, flank])
    return normal / [math.cos(math.radians(gear.helix_deg)), 1.0]


def gap(gear: Gear, radii: np.ndarray) -> np.ndarray:
    """Half the angle of the gap at each radius: the largest that any position of the rack cuts."""
    profile, r = rack(gear), gear.reference
    reach = 1.2 * math.sqrt(max(radii[-1] ** 2 - (0.8 * r) ** 2, 1.0))
    widest = np.zeros_like(radii)
    for rolled in np.linspace(-reach / r, reach / r, ROLLS):
        x = profile[:, 0] + r * rolled
        y = r + gear.off_mm - profile[:, 1]
        along = np.hypot(x, y)
        angle = np.arctan2(x, y) - rolled
        # pieces between neighbouring points of the rack: on each the radius runs one way
        low = int(np.argmin(along))
        for piece in (slice(low, None), slice(low, None, -1)):
            at, to = along[piece], angle[piece]
            if len(at) > 1:
                cut = np.interp(radii, at, to, left=-1, right=-1)
                widest = np.maximum(widest, cut)
    return widest


class Flanks:
    """A flank as points of the radius and the height, and what measuring tools find on it."""

    def __init__(self, gear: Gear) -> None:
        self.gear = gear
        root = gear.reference + gear.off_mm - gear.hob.addendum
        tip = gear.reference + gear.off_mm + gear.hob.module
        self.radii = np.linspace(root + 0.02 * gear.hob.module, tip, RADII)
        self.half_gap = gap(gear, self.radii)
        self.twist = math.sin(math.radians(gear.helix_deg)) * 2 / (gear.hob.module * gear.teeth)

    def points(self, angle: np.ndarray, heights: np.ndarray) -> np.ndarray:
        turned = angle[:, None] + self.twist * heights[None, :]
        radius = self.radii[:, None]
        return np.stack([radius * np.sin(turned), radius * np.cos(turned), np.broadcast_to(heights, turned.shape)])

    def span(self, teeth: int) -> float:
        """Least distance of two planes about that many teeth, over their tilt."""
        pitch = 2 * math.pi / self.gear.teeth
        heights = np.linspace(-12 * self.gear.hob.module, 12 * self.gear.hob.module, HEIGHTS)
        right = self.points(teeth * pitch / 2 - self.half_gap, heights)
        # a caliper's jaw does not reach into the rounded root
        right = right[:, self.radii > self.gear.reference + self.gear.off_mm - JAW * self.gear.hob.module]

        def width(tilt: float) -> float:
            normal = np.array([math.cos(tilt), 0.0, math.sin(tilt)])
            # the teeth are symmetrical about the radius through their middle, turned by half a turn about it
            return 2 * peak(np.tensordot(normal, right, 1))

        most = math.radians(abs(self.gear.helix_deg)) + 0.05
        return least(width, -most, most)

    def over_balls(self, ball: float) -> float:
        heights = np.linspace(-2.5 * self.gear.hob.module, 2.5 * self.gear.hob.module, HEIGHTS)
        flank = self.points(self.half_gap, heights)

        def clearance(radius: float) -> float:
            centre = np.array([0.0, radius, 0.0])[:, None, None]
            squared = np.sum((flank - centre) ** 2, axis=0)
            return math.sqrt(-peak(-squared)) - ball / 2

        low, high = self.radii[0], self.radii[-1] + ball
        for _ in range(50):
            middle = (low + high) / 2
            low, high = (middle, high) if clearance(middle) < 0 else (low, middle)
        opposite = 1.0 if self.gear.teeth % 2 == 0 else math.cos(math.pi / 2 / self.gear.teeth)
        return 2 * low * opposite + ball


def peak(values: np.ndarray) -> float:
    """Largest of a smooth surface: the largest of its points, and the parabolas through its neighbours."""
    i, j = np.unravel_index(int(np.argmax(values)), values.shape)
    top = float(values[i, j])
    for line, at in ((values[:, j], i), (values[i, :], j)):
        if 0 < at < len(line) - 1:
            a, b, c = float(line[at - 1]), float(line[at]), float(line[at + 1])
            bend = a - 2 * b + c
            top += -((a - c) ** 2) / (8 * bend) if bend < 0 else 0.0
    return top


def least(of, low: float, high: float) -> float:
    share = (math.sqrt(5) - 1) / 2
    for _ in range(40):
        a, b = high - share * (high - low), low + share * (high - low)
        low, high = (low, b) if of(a) < of(b) else (a, high)
    return of((low + high) / 2)


def involute(angle: float) -> float:
    return math.tan(angle) - angle


def closed_span(gear: Gear, k: int) -> float:
    alpha, beta = math.radians(gear.hob.pressure_deg), math.radians(gear.helix_deg)
    transverse = math.atan(math.tan(alpha) / math.cos(beta))
    whole = math.pi * (k - 0.5) + gear.teeth * involute(transverse)
    return gear.hob.module * math.cos(alpha) * whole + 2 * gear.off_mm * math.sin(alpha)


def closed_balls(gear: Gear, ball: float) -> float:
    alpha, beta, m, z = math.radians(gear.hob.pressure_deg), math.radians(gear.helix_deg), gear.hob.module, gear.teeth
    transverse = math.atan(math.tan(alpha) / math.cos(beta))
    wanted = ball / (m * z * math.cos(alpha)) - (math.pi / 2 - 2 * gear.off_mm / m * math.tan(alpha)) / z + involute(transverse)
    low, high = 0.0, math.pi / 2 - 1e-9
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if involute(middle) < wanted else (low, middle)
    opposite = 1.0 if z % 2 == 0 else math.cos(math.pi / 2 / z)
    return 2 * gear.reference * math.cos(transverse) / math.cos(low) * opposite + ball


def spanned(gear: Gear) -> int:
    """Teeth over which the span touches nearest to the middle of the flanks."""
    alpha, beta = math.radians(gear.hob.pressure_deg), math.radians(gear.helix_deg)
    base = 2 * gear.reference * math.cos(math.atan(math.tan(alpha) / math.cos(beta)))
    tilt = math.asin(math.sin(abs(beta)) * math.cos(alpha))
    middle = 2 * (gear.reference + gear.off_mm)

    def off(k: int) -> float:
        return abs(math.hypot(base, closed_span(gear, k) * math.cos(tilt)) - middle)

    return min(range(2, max(3, gear.teeth // 2 + 1)), key=off)


def usual(module: float, **more: float) -> Hob:
    return Hob(module, 1.25 * module, 0.38 * module, **more)


TEN = {
    "spur": Gear(usual(2.0), 40, 0.0, 0.0),
    "spur, odd": Gear(usual(3.0), 23, 0.0, 0.0),
    "helical, right hand": Gear(usual(2.0), 40, 20.0, 0.0),
    "helical, left hand": Gear(usual(2.5), 31, -15.0, 0.0),
    "shifted outwards": Gear(usual(2.0), 17, 0.0, 0.8),
    "shifted inwards": Gear(usual(2.0), 50, 12.0, -0.5),
    "few teeth, undercut": Gear(usual(2.0), 9, 0.0, 0.0),
    "few teeth, shifted": Gear(usual(1.5), 12, 25.0, 0.6),
    "two starts, left hand": Gear(usual(4.0), 28, -30.0, 0.0, starts=2),
    "diametral pitch 10, 14.5 degrees": Gear(Hob(2.54, 1.157 * 2.54, 0.209 * 2.54, 14.5), 36, 0.0, 0.0),
}


def compare(name: str, gear: Gear, expected: dict[str, tuple[float, float]]) -> bool:
    """Sizes as generated beside those expected: by name the argument (teeth spanned, ball) and the size."""
    flanks, good = Flanks(gear), True
    for what, (argument, size) in expected.items():
        found = flanks.span(int(argument)) if what == "span" else flanks.over_balls(argument)
        off = found - size
        good &= abs(off) <= WITHIN_MM
        print(f"{name:34} {what:5} {argument:7.3f}  expected {size:9.4f}  generated {found:9.4f}  {off * 1e3:+6.2f} µm")
    return good


def ten() -> bool:
    good = True
    for name, gear in TEN.items():
        k, ball = spanned(gear), 1.728 * gear.hob.module
        good &= compare(name, gear, {"span": (k, closed_span(gear, k)), "balls": (ball, closed_balls(gear, ball))})
    return good


def certificate(path: Path, tools: Path, number: int) -> bool:
    tool = next(t for t in tomllib.loads(tools.read_text())["tool"] if t["number"] == number)
    module = tool.get("module_mm") or 25.4 / tool["diametral_pitch"]
    hob = Hob(module, tool.get("addendum_mm", 1.25 * module), tool.get("tip_radius_mm", 0.38 * module), tool.get("pressure_angle_deg", 20.0))
    gears = [f for f in json.loads(path.read_text())["features"] if f["kind"] == "gear" and f["size"]]
    good = bool(gears)
    for found in gears:
        size = found["size"]
        nominal = Gear(hob, found["teeth"], found["helix_deg"], 0.0)
        datum = tool["diameter_mm"] / 2 - hob.addendum
        gear = Gear(hob, found["teeth"], found["helix_deg"], size["distance_mm"] - datum - nominal.reference)
        expected = {"span": (size["spanned"], size["span_mm"])}
        if size["over_balls_mm"] is not None:
            expected["balls"] = (size["ball_mm"], size["over_balls_mm"])
        good &= compare(f"line {found['line']}, {found['verdict']}", gear, expected)
    return good


def main() -> int:
    match sys.argv[1:]:
        case []:
            return 0 if ten() else 1
        case [path, tools, number]:
            return 0 if certificate(Path(path), Path(tools), int(number)) else 1
        case _:
            print(__doc__)
            return 2


if __name__ == "__main__":
    raise SystemExit(main())
