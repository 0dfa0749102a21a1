#!/usr/bin/env python3
"""The path planner's table of docs/planner.md: each program of tools/planner-programs.py (and 3D_Chips of LinuxCNC's package, where
that is installed) with G61 and G64 P, without a limit of jerk and with 20 and 50 m/s3.

    python tools/planner-table.py [--leadscrew PATH] [PROGRAM...]      times, peaks and what planning takes, as Markdown
    python tools/planner-table.py --linuxcnc [--longest S] [PROGRAM...] the same programs by LinuxCNC, without a limit of jerk

X, Y, Z have 200 mm/s and 1000 mm/s2 each, setpoints come each millisecond. A time is that of motion; a peak is the largest of any
axis over its limit, by differences of the setpoints. It fails where a program takes longer than with G61, or with a larger P longer
than with a smaller one, by more than 0.1 %, and where a peak is above its limit by more than 0.1 % (speed), 1 % (acceleration) or 5 %
(jerk). LinuxCNC is run in a HAL session of its own, as root, and its setpoints are taken by halsampler: its time is from the first
motion to the last.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
from importlib.machinery import SourceFileLoader
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = Path("/usr/share/linuxcnc/ncfiles/3D_Chips.ngc")
MODES = ("G61", "G64 P0.001", "G64 P0.01", "G64 P0.1")
JERKS = ("none", "20", "50")
SPEED, ACCELERATION = 200.0, 1000.0
PERIOD = 1e-3


def written(folder: Path, wanted: list[str]) -> dict[str, Path]:
    SourceFileLoader("programs", str(ROOT / "tools/planner-programs.py")).load_module().write(folder)
    if PACKAGE.is_file():
        text = re.sub(r"(?m)^N\d+.*M6.*\n", "", PACKAGE.read_text())
        (folder / "3D_Chips.ngc").write_text(text)
    names = {path.stem: path for path in sorted(folder.glob("*.ngc"))}
    if unknown := set(wanted) - set(names):
        sys.exit(f"no such program: {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    return {name: path for name, path in names.items() if not wanted or name in wanted}


def with_mode(path: Path, mode: str) -> Path:
    """The program with this path mode, in place of its own."""
    lines = [re.sub(r"G6[14](\.1)?\s*(P[.\d]+)?\s*(Q[.\d]+)?", "", line) for line in path.read_text().splitlines()]
    first = next(k for k, line in enumerate(lines) if re.search(r"G0?[01]\b|G0?[01][XYZ]", line))
    made = path.parent / f"{path.stem}-{mode.replace(' ', '')}.ngc"
    made.write_text("\n".join([*lines[:first], mode, *lines[first:]]) + "\n")
    return made


def machine(jerk: str, folder: Path) -> str:
    if jerk == "none":
        return "bench-xyz"
    if jerk == "20":
        return "bench-xyz-jerk20"
    path = folder / "bench-xyz-jerk50.toml"
    text = (ROOT / "machines/bench-xyz-jerk20.toml").read_text()
    path.write_text(re.sub(r"(jerk_(?:feed|rapid)_m_per_s3 = )20\b", r"\g<1>50", text))
    return str(path)


def planned(leadscrew: str, program: Path, of: str) -> tuple[float, dict[str, float], float]:
    """Time of motion, the peak of each quantity, and the processor time that planning took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran = subprocess.run([leadscrew, "time", str(program), "--machine", of, "--format", "json"], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if ran.returncode:
        sys.exit(f"{program.name} on {of}: {ran.stderr}")
    found = json.loads(ran.stdout)
    peaks = {key: max(axis[key] for axis in found["peaks"]) for key in ("speed_mm_per_s", "acceleration_mm_per_s2", "jerk_m_per_s3")}
    return found["motion_time_s"], peaks, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def table(leadscrew: str, programs: dict[str, Path], folder: Path) -> list[str]:
    wrong = []
    print("| program | mode | none: s | of G61 | 20 m/s³: s | of G61 | 50 m/s³: s | of G61 | speed, acceleration, jerk at most | planned in s |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, path in programs.items():
        stops, before = {}, {}
        for mode in MODES:
            cells, highest, spent = [], [0.0, 0.0, 0.0], []
            for jerk in JERKS:
                time, peaks, took = planned(leadscrew, with_mode(path, mode), machine(jerk, folder))
                shares = [peaks["speed_mm_per_s"] / SPEED, peaks["acceleration_mm_per_s2"] / ACCELERATION]
                if jerk != "none":
                    shares.append(peaks["jerk_m_per_s3"] / float(jerk))
                of, least = f"{name}, {mode}, {jerk} m/s³", min(stops.setdefault(jerk, time), before.get(jerk, time))
                if time > least * 1.001:
                    wrong.append(f"{of}: {time:.3f} s, where G61 or a smaller P takes {least:.3f}")
                wrong += [f"{of}: {share:.3f} of a limit" for share, most in zip(shares, (1.001, 1.01, 1.05)) if share > most]
                before[jerk] = time
                cells += [f"{time:.2f}", f"{time / stops[jerk]:.3f}"]
                highest = [max(pair) for pair in zip(highest, [*shares, 0.0][:3])]
                spent.append(f"{took:.2f}")
            peak = ", ".join(f"{share:.3f}" for share in highest)
            print(f"| {name} | {mode} | {' | '.join(cells)} | {peak} | {', '.join(spent)} |", flush=True)
    return wrong


def linuxcnc_files(folder: Path) -> None:
    limits = f"MAX_VELOCITY = {SPEED}\nMAX_ACCELERATION = {ACCELERATION}\nMIN_LIMIT = -2000\nMAX_LIMIT = 2000\n"
    parts = []
    for number, letter in enumerate("XYZ"):
        joint = "TYPE = LINEAR\nFERROR = 5\nMIN_FERROR = 5\nHOME = 0\nHOME_OFFSET = 0\nHOME_SEARCH_VEL = 0\nHOME_LATCH_VEL = 0\nHOME_SEQUENCE = 0\n"
        parts.append(f"[AXIS_{letter}]\n{limits}[JOINT_{number}]\n{limits}{joint}")
    text = (ROOT / "machines/hal/linuxcnc.ini").read_text()
    head = re.sub(r"(MAX|DEFAULT)_LINEAR_VELOCITY = \d+", rf"\1_LINEAR_VELOCITY = {SPEED * 2}", text[: text.index("[AXIS_X]")])
    (folder / "linuxcnc.ini").write_text(head + "\n".join(parts))
    (folder / "tools.tbl").write_text((ROOT / "programs/tools.tbl").read_text())
    (folder / "linuxcnc.var").touch()


def by_linuxcnc(program: Path, longest: float, folder: Path) -> tuple[float, float] | None:
    """Time from the first to the last motion and the peak of acceleration; none: it was not over in time."""
    samples = folder / "samples"
    joints = [f"net {letter} joint.{k}.motor-pos-cmd => joint.{k}.motor-pos-fb sampler.0.pin.{k}" for k, letter in enumerate("xyz")]
    lines = [
        *("loadusr linuxcncsvr -ini linuxcnc.ini", "loadusr -w sleep 1", "loadusr -Wn iocontrol io -ini linuxcnc.ini", "loadrt tpmod"),
        *("loadrt homemod", "loadrt trivkins coordinates=XYZ", "loadrt motmod servo_period_nsec=1000000 num_joints=3 num_spindles=1"),
        *("loadrt sampler depth=60000 cfg=fff", "addf motion-command-handler servo-thread", "addf motion-controller servo-thread"),
        *("addf sampler.0 servo-thread", *joints, "net on iocontrol.0.user-enable-out => iocontrol.0.emc-enable-in"),
        *("setp spindle.0.at-speed 1", "net prepare iocontrol.0.tool-prepare => iocontrol.0.tool-prepared"),
        *("net change iocontrol.0.tool-change => iocontrol.0.tool-changed", "start", f"loadusr -w {ROOT}/tools/hal-first"),
        *("loadusr -Wn inihal milltask -ini linuxcnc.ini", f"loadusr halsampler {samples}"),
        *(f"loadusr -w {ROOT}/tools/hal-linuxcnc.py linuxcnc.ini {program} 0 0 0 {longest}", "loadusr -w sleep 1"),
    ]
    (folder / "run.hal").write_text("\n".join(lines) + "\n")
    own = ["unshare", "--mount", "--ipc", "--pid", "--fork", "--mount-proc", "unshare", "--net"]
    said = subprocess.run([*own, "sh", "-c", "ip link set lo up; exec nice -n -15 halrun run.hal"], cwd=folder, capture_output=True, text=True)
    if "not over within" in said.stdout + said.stderr:
        return None
    rows = [[float(word) for word in line.split()[:3]] for line in samples.read_text().splitlines() if "overrun" not in line]
    moving = [k for k in range(1, len(rows)) if max(abs(a - b) for a, b in zip(rows[k], rows[k - 1])) > 1e-7]
    if not moving:
        sys.exit(f"LinuxCNC did not run {program.name}:\n{said.stdout}{said.stderr}")
    first, last = moving[0], moving[-1]
    seconds = (abs(rows[k + 1][j] - 2 * rows[k][j] + rows[k - 1][j]) for k in range(first, last) for j in range(3))
    return (last - first + 1) * PERIOD, max(seconds) / PERIOD**2


def beside(programs: dict[str, Path], longest: float, folder: Path) -> None:
    linuxcnc_files(folder)
    os.chmod(folder, 0o777)
    os.environ.update(HOME=str(folder), RTAPI_UID="65534")
    print(f"| program | {' | '.join(MODES)} | acceleration at most |")
    print("|---" * (len(MODES) + 2) + "|")
    for name, path in programs.items():
        found = [by_linuxcnc(with_mode(path, mode), longest, folder) for mode in MODES]
        cells = [f"over {longest:.0f}" if run is None else f"{run[0]:.2f}" for run in found]
        peaks = [run[1] / ACCELERATION for run in found if run]
        print(f"| {name} | {' | '.join(cells)} | {f'{max(peaks):.3f}' if peaks else '–'} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="*", metavar="PROGRAM")
    parser.add_argument("--leadscrew", default=str(ROOT / "target/release/leadscrew"))
    parser.add_argument("--linuxcnc", action="store_true")
    parser.add_argument("--longest", type=float, default=200.0, metavar="S")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        programs = written(folder, asked.programs)
        if asked.linuxcnc:
            return beside(programs, asked.longest, folder)
        if wrong := table(asked.leadscrew, programs, folder):
            sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
