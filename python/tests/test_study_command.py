"""``leadscrew study FILE.toml``: table, page and exit code; and what of a file is refused."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from conftest import one_hole

STUDY = """
[study]
program = "hole.ngc"
design = "latin-hypercube"
cases = 12
out = "out"

[factors]
"plant.axes.z.errors.scale_error_ppm" = { from = -100, to = 100 }
"program.rpm" = [900, 1100]

[[characteristics]]
name = "depth_mm"
of = "hole"
lower = 19.9
upper = 20.1

[[characteristics]]
name = "pitch_diameter_mm"
of = "thread"
lower = 5.350
upper = 5.500

[executor]
workers = 2
"""


def study(folder: Path, text: str, *words: str) -> "subprocess.CompletedProcess[str]":
    (folder / "hole.ngc").write_text(one_hole().replace("S1000", "S${rpm}").replace("F1000", "F${rpm}"))
    (folder / "study.toml").write_text(text)
    asked = [sys.executable, "-m", "leadscrew", "study", str(folder / "study.toml"), *words]
    return subprocess.run(asked, capture_output=True, text=True, check=False)


def test_a_study_says_how_capable_the_process_is_and_goes_on_where_it_was(tmp_path: Path) -> None:
    done = study(tmp_path, STUDY)
    assert done.returncode == 0, done.stderr + done.stdout
    assert "24 of 24 cases" in done.stderr
    for said in ("24 good", "Cpk", "in 10,000", "effect of plant.axes.z.errors.scale_error_ppm", "leadscrew run"):
        assert said in done.stdout, done.stdout
    # 200 ppm (of a Latin hypercube the outermost of 12 cases, not quite) over the 98.5 mm that a drill of 118.5 mm leaves at 20 mm
    effect = next(line for line in done.stdout.splitlines() if line.split()[:3] == ["effect", "of", "plant.axes.z.errors.scale_error_ppm"])
    assert float(effect.split()[3]) == pytest.approx(-200e-6 * 98.5, rel=0.15), effect
    table = pq.read_table(tmp_path / "out" / "table.parquet")
    assert table.num_rows == 48 and set(table["program.rpm"].to_pylist()) == {900, 1100}
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.count("<svg") == 2 and "depth_mm" in page
    again = study(tmp_path, STUDY)
    assert again.stdout == done.stdout
    files = list((tmp_path / "out" / "results").glob("part-*/*.parquet"))
    assert study(tmp_path, STUDY).returncode == 0
    assert list((tmp_path / "out" / "results").glob("part-*/*.parquet")) == files, "nothing ran again"


@pytest.mark.parametrize(
    ("of", "to", "expected"),
    [
        ('design = "latin-hypercube"', 'desing = "sobol"', "unknown key desing: did you mean design"),
        ("scale_error_ppm", "scale_error_um", "did you mean `scale_error_ppm`"),
        ("{ from = -100, to = 100 }", "{ from = -100 }", "expected a list of levels"),
        ('design = "latin-hypercube"', 'design = "full-factorial"', "a full factorial needs a list of levels"),
        ("cases = 12", "cases = 1_000_000_000_000", "expected 10,000,000 at most"),
        ("cases = 12", 'cases = "many"', "expected a whole number"),
        ('program = "hole.ngc"', 'program = "no.ngc"', "there is no program"),
        ("upper = 5.500", "uper = 5.500", "unknown key uper: did you mean upper"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_runs(of: str, to: str, expected: str, tmp_path: Path) -> None:
    done = study(tmp_path, STUDY.replace(of, to))
    assert done.returncode == 2 and expected in done.stderr, done.stderr
    assert not (tmp_path / "out").exists()
