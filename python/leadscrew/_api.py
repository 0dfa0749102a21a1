"""The functions: each is the command of its name, with its answer as a value."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from typing import Any, Unpack

from . import _leadscrew as _native
from ._errors import Diagnostic
from ._machine import Machine, source
from ._options import CamOptions, Path, PolygonOptions, ProgramOptions, RunOptions, words
from ._result import Result


def check(
    program: Path,
    *,
    machine: Machine | Path | None = None,
    text: str | bytes | None = None,
    **options: Unpack[ProgramOptions],
) -> list[Diagnostic]:
    """Everything that is wrong with a program, and what is likely to hurt, in the order of its text; nothing moves.

    ``text`` stands for the file that ``program`` names; ``machine`` is a built-in model, a file or a :class:`Machine`.
    :class:`Refused`: machine, tools or options cannot be read. A program that is wrong is no exception here.
    """
    asked = ["check", *words(options), "--", os.fspath(program)]
    found = json.loads(_native.check(asked, _bytes(text), source(machine)))
    return [Diagnostic._of(each) for each in found]


def canon(
    program: Path,
    *,
    machine: Machine | Path | None = None,
    text: str | bytes | None = None,
    **options: Unpack[ProgramOptions],
) -> list[dict[str, Any]]:
    """The operations that a program means, in machine coordinates: ``op``, ``line``, and keys that carry their units.

    :class:`Refused` where the program is.
    """
    asked = ["canon", *words(options), "--", os.fspath(program)]
    value: list[dict[str, Any]] = json.loads(_native.canon(asked, _bytes(text), source(machine)))
    return value


def time(
    program: Path,
    *,
    machine: Machine | Path | None = None,
    text: str | bytes | None = None,
    operations: bool = False,
    fast: bool = False,
    **options: Unpack[ProgramOptions],
) -> dict[str, Any]:
    """How long a program takes, by the planner that would run it: ``total_time_s``, ``motion_time_s``, what takes it, per
    tool (``tools``), per axis (``peaks``), and the longest operations, or each with ``operations=True``.

    ``fast=True``: from a sample of a long program; ``within_share`` says how far the total may be off, at most 0.02, and
    tools, axes and operations are not told. A program that is too short or too uneven for that is planned as a whole.

    :class:`Refused` where the program is.
    """
    asked = ["time", *words({**options, "operations": operations, "fast": fast}), "--", os.fspath(program)]
    value: dict[str, Any] = json.loads(_native.time(asked, _bytes(text), source(machine)))
    return value


def run(
    program: Path,
    *,
    machine: Machine | Path | None = None,
    plant: Machine | Path | None = None,
    text: str | bytes | None = None,
    trace: bool = False,
    progress: Callable[[float, float], object] | None = None,
    **options: Unpack[RunOptions],
) -> Result:
    """Run a program on the simulated machine and judge the workpiece.

    The control believes ``machine``; what is simulated is ``plant`` where one is named, and the seed draws how it differs
    from its file. ``trace=True`` records every servo period (24 columns of 8 bytes at 4 kHz: 0.8 MB for a second of the
    tapping centre). ``progress(at_s, planned_s)`` is called now and then with the machine's time and the planned one, in s;
    what it raises ends the run. Python's lock is released meanwhile, and Ctrl-C ends a run in the main thread.

    :class:`Refused` where the program is. An alarm and a workpiece out of tolerance are results.
    """
    asked = ["run", *words(options), "--", os.fspath(program)]
    native = _native.run(
        asked, _bytes(text), source(machine), source(plant), trace=trace, progress=progress
    )
    return Result(native)


def polygon(
    *,
    across_flats: float,
    machine: Machine | Path | None = None,
    **options: Unpack[PolygonOptions],
) -> dict[str, Any]:
    """The flattest polygon of ``across_flats`` mm that a machine can turn: ``flatness_um``, what oscillates (``ways``), and the
    block that cuts it (``gcode``)."""
    asked = ["polygon", *words({"across_flats": across_flats, **options})]
    value: dict[str, Any] = json.loads(_native.polygon(asked, source(machine)))
    return value


def cam(
    table: Path | None = None,
    *,
    machine: Machine | Path | None = None,
    **options: Unpack[CamOptions],
) -> dict[str, Any]:
    """From a cam's lift (a ``table`` of degrees and mm, or a closed form) to the wheel's path: ``centre_mm`` over a turn of the
    work in equal steps, shape ``(nodes,)``; ``work_speed_rpm`` of the same shape; ``highest_rpm``; ``gcode``."""
    file = [] if table is None else ["--", os.fspath(table)]
    asked = ["cam", *words(options), *file]
    value: dict[str, Any] = json.loads(_native.cam(asked, source(machine)))
    return value


def _bytes(text: str | bytes | None) -> bytes | None:
    return text.encode() if isinstance(text, str) else text
