"""Options of the functions: those of the command line by their names, with ``_`` for ``-``.

They are read by the command's own reader, so that what it accepts is accepted here, and what it refuses is refused in the same
words. ``None`` is as if nothing was said; ``True`` is an option without a value; a list is an option that is given several times.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal, TypedDict, TypeAlias

Path: TypeAlias = str | os.PathLike[str]

Dialect: TypeAlias = Literal[
    "linuxcnc", "grbl", "brother", "fanuc", "haas", "mitsubishi",
    "haas-lathe", "fanuc-lathe-a", "fanuc-lathe-b", "fanuc-lathe-c", "toyoda"
]


class ProgramOptions(TypedDict, total=False):
    """Where tools and parameters come from, and how a program is read."""

    tools: Path | None
    """Tool table, TOML or LinuxCNC's ``.tbl``; ``None``: ``tools.toml`` beside the program, else the built-in one."""
    tool_unit: Literal["mm", "inch"] | None
    parameters: Path | None
    """Parameter file (``.var``) with work offsets."""
    inputs: Path | None
    missing_tools: Literal["refuse", "stand-in"] | None
    pre_drilled: bool | None
    """Holes that the program taps and does not drill are there."""
    stock: str | None
    """The stock as a comment ``(STOCK ...)`` has it, mm, such as ``DIA 32 LENGTH 80``; ``None``: as the program or the machine's file says."""
    tapping: Literal["synchronised", "floating"] | None
    clutch_dwell: Literal["refuse", "warn"] | None
    dialect: Dialect | None
    decimal_point: Literal["increments", "calculator"] | None
    accept: Sequence[Literal["unknown-m-codes", "no-end"]] | None
    block_skip: Sequence[int] | None
    subprograms: Sequence[Path] | None
    cams: Path | None
    phase_table: Path | None
    compensation: Literal["off", "address", "shift", "wrong", "harmonics", "learn"] | None
    estimator: Literal["least-squares", "flanks", "maximum"] | None
    work_speed: Literal["constant", "even"] | None
    feed_forward: Literal["on", "off"] | None
    tapping_preset: Literal["gentle", "standard", "fast", "max"] | None


class RunOptions(ProgramOptions, total=False):
    """How a run is done."""

    seed: int | None
    part: int | None
    """Seed of what the control does not know of its machine, and of what scatters."""
    material: str | None
    """Material of the workpiece, such as ``"C45"``, ``"42CrMo4"``, ``"AlSi"``."""
    synchronisation: Literal["command", "encoder", "encoder-no-prediction", "encoder-no-feed-forward"] | None
    force_ramp: float | None
    """Force the tapping ramp from rest to full speed into this time, s."""
    learning: Path | None
    """File of what is learnt from tap to tap; ``"off"``: none."""
    start_at: str | int | None
    """Begin at a line, at ``"hole 5"`` or at ``"tool 3"``: ``--from``."""
    program_changed: bool | None
    """Begin there though the program was changed since the sync record was written."""
    fault: Sequence[str] | str | None
    """Let the machine fail: ``"WHAT at MOMENT"``, as ``leadscrew run --help`` has it."""
    operator: Sequence[str] | str | None
    recover: Literal[True, "out", "continue"] | None
    units: Literal["mm", "inch"] | None
    state: Path | None
    renew_tool: Sequence[int] | None
    """Tools in whose place new ones are since they broke: ``state`` keeps which are broken."""


class PolygonOptions(TypedDict, total=False):
    """What polygon, and with which cutter; see ``leadscrew polygon --help``."""

    sides: int
    insert_angles: Sequence[float]
    inserts: int
    tip_radius: float
    """From the tool spindle's axis to the inserts' tips, mm."""
    ratio: str
    """Turns of work and tool, such as ``"1:2"``."""
    stock: float
    """Diameter of the bar, mm."""
    speed: float
    """Speed of the work, rev/min."""
    flatness: float
    """Flatness wanted, µm."""
    actuator: Literal["auto", "x", "y", "xy", "x-phase", "all", "phase"]
    harmonics: int
    phase_table: Path
    simulate: bool
    length: float
    """Length of the polygon, mm."""
    feed: float
    """Feed along Z, mm per turn of the work."""
    tool: int
    tools: Path
    internal: bool


class CamOptions(TypedDict, total=False):
    """Which cam, and which wheel; see ``leadscrew cam --help``."""

    form: Literal["eccentric", "harmonic", "lobes", "polynomial", "automotive"]
    base: float
    """Radius of the base circle, mm."""
    lift: float
    """mm."""
    half_angle: float
    """Degrees."""
    lobes: int
    follower: Literal["flat", "roller", "knife"]
    roller_radius: float
    """mm."""
    wheel_radius: float
    """mm."""
    wheel_wear: float
    """mm."""
    speed: float
    """Speed of the work, rev/min."""
    nodes: int
    number: int


#: Options whose name is a word of Python, or would be read as another one.
_NAMES = {"start_at": "from"}


def words(options: Mapping[str, object]) -> list[str]:
    """The options as words of the command line."""
    found: list[str] = []
    for key, value in options.items():
        name = "--" + _NAMES.get(key, key).replace("_", "-")
        values: Iterable[object]
        if value is None or value is False:
            continue
        if value is True:
            found.append(name)
            continue
        if isinstance(value, (str, os.PathLike)):
            values = [value]
        elif isinstance(value, Iterable):
            values = value
        else:
            values = [value]
        found.extend(f"{name}={os.fspath(each) if isinstance(each, os.PathLike) else each}" for each in values)
    return found
