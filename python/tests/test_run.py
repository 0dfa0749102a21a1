"""A run: verdict, features, trace, events, report; its seed, its progress, its end by Ctrl-C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import leadscrew
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from conftest import PLATE, one_hole


@pytest.fixture(scope="module")
def result() -> leadscrew.Result:
    return leadscrew.run("hole.ngc", text=one_hole(), seed=3, trace=True)


def test_a_sound_program_passes(result: leadscrew.Result) -> None:
    assert result.passed and result.ending == "good"
    assert result.certificate["seed"] == 3
    assert result.cycle_time_s == pytest.approx(leadscrew.time("hole.ngc", text=one_hole())["total_time_s"], rel=0.1)


def test_features_are_a_table_with_units(result: leadscrew.Result) -> None:
    table = result.features
    assert table["kind"].to_pylist() == ["hole", "thread"]
    assert table["verdict"].to_pylist() == ["pass", "pass"]
    assert table.schema.field("pitch_diameter_mm").metadata == {b"unit": b"mm"}
    diameter = table["pitch_diameter_mm"].to_pylist()
    # ISO 965-1, M6 6H: pitch diameter from 5.350 to 5.500 mm; a hole has none
    assert diameter[0] is None and 5.350 <= diameter[1] <= 5.500
    assert table["contact_cut"].to_pylist() == [True, True]


def test_the_trace_is_that_of_the_commands_file_to_the_bit(result: leadscrew.Result, tmp_path: Path) -> None:
    program = tmp_path / "hole.ngc"
    program.write_text(one_hole())
    words = ["run", str(program), "--seed", "3", "--out", str(tmp_path / "out"), "-q"]
    subprocess.run([sys.executable, "-m", "leadscrew", *words], check=True)
    written = pq.read_table(tmp_path / "out" / "trace.parquet")
    trace = result.trace
    assert trace.column_names == written.column_names
    for name in written.column_names:
        column = trace[name].cast(pa.string()) if name == "state" else trace[name]
        assert column.combine_chunks().equals(written[name].cast(column.type).combine_chunks()), name
    assert trace.schema.field("z_truth_mm").metadata == {b"unit": b"mm"}
    assert trace.schema.field("control_sync_error_um").metadata == {b"unit": "µm".encode()}
    assert trace.schema.metadata[b"machine"] == b"tapping-center" and trace.schema.metadata[b"seed"] == b"3"


def test_the_trace_is_not_copied(result: leadscrew.Result) -> None:
    native = result._native.trace
    assert native is not None
    one, other = pa.table(native), pa.table(native)
    address = [table["z_truth_mm"].chunk(0).buffers()[1].address for table in (one, other)]
    assert address[0] == address[1]
    numbers = one["z_truth_mm"].chunk(0).to_numpy(zero_copy_only=True)
    assert len(numbers) == one.num_rows == len(native)


def test_a_run_without_a_trace_says_how_to_get_one() -> None:
    with pytest.raises(ValueError, match="trace=True"):
        leadscrew.run("hole.ngc", text=one_hole()).trace


def test_events_and_report(result: leadscrew.Result, tmp_path: Path) -> None:
    changes = [event for event in result.events if event.kind == "tool-changed"]
    assert [event.text for event in changes] == ["tool 2 in the spindle", "tool 3 in the spindle"]
    assert all(early.time_s <= late.time_s for early, late in zip(changes, changes[1:]))
    page = result.report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text() == page and "M6" in page


def test_the_same_seed_is_the_same_to_the_bit_and_another_one_is_not() -> None:
    one, again, other = (leadscrew.run("hole.ngc", text=one_hole(), seed=seed).certificate for seed in (5, 5, 6))
    assert one == again and one["features"] != other["features"]


def test_an_alarm_is_a_result() -> None:
    result = leadscrew.run("hole.ngc", text=one_hole(), fault="drive-fault spindle at depth 5mm")
    assert not result.passed and result.ending == "alarm"
    assert result.certificate["alarms"][0]["number"] > 0


def test_a_plant_that_differs_is_cut_as_it_is_and_believed_as_the_machine_file_has_it() -> None:
    machine = leadscrew.Machine.load("tapping-center")
    # errors are zero at the work's zero; the drill is 118.5 mm long: at a depth of 20 mm the axis stands 98.5 mm above that
    longer = machine.with_({"axes.z.errors.scale_error_ppm": 1000})
    depth = [
        leadscrew.run("hole.ngc", text=one_hole(), machine=machine, plant=plant, seed=1).features["depth_mm"].to_pylist()[0]
        for plant in (machine.with_({"axes.z.errors.scale_error_ppm": 0}), longer)
    ]
    assert depth[1] - depth[0] == pytest.approx(-1000e-6 * (118.5 - 20), rel=0.005)


def test_a_plant_with_other_axes_is_refused() -> None:
    with pytest.raises(leadscrew.Refused, match="does not fit"):
        leadscrew.run("hole.ngc", text=one_hole(), plant="lathe")


def test_progress_is_told_and_what_it_raises_ends_the_run() -> None:
    told: list[tuple[float, float]] = []
    leadscrew.run("hole.ngc", text=one_hole(), progress=lambda at, planned: told.append((at, planned)))
    assert told and all(0 < at for at, _ in told) and len({planned for _, planned in told}) == 1

    def enough(at: float, planned: float) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        leadscrew.run("hole.ngc", text=one_hole(), progress=enough)


def test_the_lock_is_released_meanwhile() -> None:
    """Two runs in two threads meet: each waits in its progress for the other."""
    meeting = threading.Barrier(2, timeout=60)
    met = threading.local()

    def meet(at: float, planned: float) -> None:
        if not getattr(met, "already", False):
            met.already = True
            meeting.wait()

    with ThreadPoolExecutor(2) as pool:
        runs = [pool.submit(leadscrew.run, "hole.ngc", text=one_hole(), progress=meet) for _ in range(2)]
        assert all(run.result().passed for run in runs)


def test_ctrl_c_ends_a_run() -> None:
    """The plate takes seconds; the run says that it has begun, is told to end, and raises KeyboardInterrupt."""
    script = f"""
import leadscrew, sys
def begun(at, planned):
    print("begun", flush=True)
try:
    leadscrew.run({str(PLATE)!r}, progress=begun)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(7)
"""
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    os.kill(process.pid, signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 7 and said.endswith("interrupted\n")
    assert said.count("begun") < 20, "it went on"


@pytest.mark.parametrize("function", ["time", "run"])
def test_ctrl_c_ends_planning(function: str) -> None:
    """Full circles side by side: to plan all of them takes many minutes, so a program that ends within one has broken it off."""
    script = f"""
import leadscrew, sys
circles = "".join(f"G2 X{{0.001 * n:.3f}} Y0 I2 J0\\n" for n in range(400_000))
text = "G21 G90 G54 G17 G94 G64 P0.05\\nT3 M6\\nG43 H3\\nG0 X0 Y0 Z50\\nF3000\\n" + circles + "M2\\n"
print("begins", flush=True)
try:
    leadscrew.{function}("circles.ngc", text=text, machine="mill-5-axis")
except KeyboardInterrupt:
    sys.exit(7)
except leadscrew.Refused as refused:
    print(refused, flush=True)
"""
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "begins\n"
    time.sleep(2)
    os.kill(process.pid, signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 7, said
