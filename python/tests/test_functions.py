"""check, canon, time, polygon, cam: what the commands answer, as values; and what is refused."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import leadscrew
import pytest

from conftest import PLATE, one_hole


def command(*words: str) -> "subprocess.CompletedProcess[str]":
    """The command that the package brings."""
    return subprocess.run([sys.executable, "-m", "leadscrew", *words], capture_output=True, text=True, check=False)


def test_a_good_program_has_no_errors_and_a_bad_one_says_code_place_text_and_remedy() -> None:
    assert not [found for found in leadscrew.check(PLATE) if found.severity == "error"]
    # the lead of the tap is 1 mm: at 1000 rev/min the feed is 1000 mm/min
    errors = [found for found in leadscrew.check("hole.ngc", text=one_hole(1000, 1100)) if found.severity == "error"]
    assert errors
    first = errors[0]
    assert first.code is not None and first.file == "hole.ngc"
    line = one_hole(1000, 1100).splitlines().index("G99 G84 X0 Y0 Z-15 R5 F1100") + 1
    assert first.line == line and first.column is not None
    assert "1000" in f"{first.text} {first.remedy}"


def test_findings_are_those_of_the_command(tmp_path: Path) -> None:
    program = tmp_path / "hole.ngc"
    program.write_text(one_hole(1000, 1100))
    said = json.loads(command("check", str(program), "--format", "json").stdout)
    assert [found["message"] for found in said] == [found.text for found in leadscrew.check(program)]


def test_a_refused_program_raises_its_diagnostics() -> None:
    with pytest.raises(leadscrew.Refused) as caught:
        leadscrew.run("hole.ngc", text=one_hole(1000, 1100))
    assert [found.code for found in caught.value.diagnostics if found.severity == "error"]
    assert "hole.ngc" in str(caught.value)


def test_operations_are_those_of_the_command() -> None:
    ops = leadscrew.canon(PLATE)
    said = [json.loads(line) for line in command("canon", str(PLATE), "--format", "json").stdout.splitlines()]
    assert ops == said
    taps = [op for op in ops if op["op"] == "tap"]
    assert len(taps) == 12 and {tap["lead_mm"] for tap in taps} == {1.0}


def test_times_are_those_of_the_command() -> None:
    said = json.loads(command("time", str(PLATE), "--format", "json").stdout)
    assert leadscrew.time(PLATE) == said
    assert leadscrew.time(PLATE, fast=True) == said  # too short for a sample
    every = leadscrew.time(PLATE, operations=True)
    assert len(every["operations"]) > 36 and every["total_time_s"] == said["total_time_s"]


def test_a_polygon_is_that_of_the_command() -> None:
    said = json.loads(command("polygon", "--sides", "6", "--across-flats", "17", "--format", "json").stdout)
    assert leadscrew.polygon(sides=6, across_flats=17) == said
    assert said["corner_angle_deg"] == pytest.approx(120)


def test_a_cam_has_a_way_of_the_wheel_over_a_turn() -> None:
    cam = leadscrew.cam(form="eccentric", base=25, lift=8, wheel_radius=200, nodes=360)
    way = cam["centre_mm"]
    # a circle off its axis by e: the wheel's centre goes between R + r − e and R + r + e
    assert len(way) == 360
    assert max(way) == pytest.approx(25 + 200 + 4, abs=1e-6) and min(way) == pytest.approx(25 + 200 - 4, abs=1e-6)


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (lambda: leadscrew.check("no-such.ngc"), "no-such.ngc"),
        (lambda: leadscrew.run(PLATE, machine="no-such"), "no-such"),
        (lambda: leadscrew.run(PLATE, material="cheese"), "C45"),
        (lambda: leadscrew.run(PLATE, seed=-1), "--seed"),
        (lambda: leadscrew.time(PLATE, tapping_preset="furious"), "furious"),  # type: ignore[arg-type]
        (lambda: leadscrew.time(PLATE, colour="red"), "--colour"),  # type: ignore[call-arg]
    ],
)
def test_what_cannot_be_is_refused_by_name(call: object, expected: str) -> None:
    assert callable(call)
    with pytest.raises(leadscrew.Refused, match=expected):
        call()


def test_the_package_brings_the_command_with_its_exit_codes(tmp_path: Path) -> None:
    program = tmp_path / "hole.ngc"
    program.write_text(one_hole())
    good = command("run", str(program), "--out", str(tmp_path / "out"))
    assert good.returncode == 0, good.stderr
    assert (tmp_path / "out" / "report.html").is_file() and (tmp_path / "out" / "trace.parquet").is_file()
    program.write_text(one_hole(1000, 1100))
    assert command("run", str(program)).returncode == 2
    version = command("--version").stdout.split()
    assert version[:2] == ["leadscrew", leadscrew.__version__]
