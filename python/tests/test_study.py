"""Studies: cases, batches, going on, workers that are killed, other versions, full disks; statistics against closed forms."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import leadscrew
import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pytest
from leadscrew import study

from conftest import one_hole

PLAY = "plant.axes.z.structure.backlash_um"


def square(case: Mapping[str, Any]) -> dict[str, Any]:
    return {"square": case["x"] ** 2, "mark": case["seed"] * 10}


def squares(n: int) -> pa.Table:
    return study.replicated(study.full_factorial({"x": list(range(n))}), 2)


def test_a_full_factorial_has_every_combination_and_the_last_factor_varies_fastest() -> None:
    table = study.full_factorial({"a": [1, 2], "b": ["x", "y", "z"]})
    assert table["a"].to_pylist() == [1, 1, 1, 2, 2, 2] and table["b"].to_pylist() == ["x", "y", "z"] * 2


def test_a_latin_hypercube_has_one_case_in_each_stretch() -> None:
    column = np.asarray(study.latin_hypercube({"a": (10, 20), "b": (0, 1)}, n=50, seed=7)["a"])
    assert sorted(np.floor((column - 10) / 10 * 50).astype(int)) == list(range(50))


def test_a_sobol_sequence_is_even_and_takes_powers_of_two() -> None:
    column = np.asarray(study.sobol({"a": (0, 1)}, n=64, seed=1)["a"])
    assert sorted(np.floor(column * 64).astype(int)) == list(range(64))
    with pytest.raises(ValueError, match="such as 64 or 128"):
        study.sobol({"a": (0, 1)}, n=100, seed=1)


def test_factors_are_drawn_from_distributions() -> None:
    from scipy import stats

    column = np.asarray(study.sobol({"a": stats.norm(5, 2)}, n=1024, seed=1)["a"])
    assert column.mean() == pytest.approx(5, abs=0.02) and column.std() == pytest.approx(2, abs=0.05)


def test_a_study_of_a_million_million_cases_is_refused_before_it_takes_memory() -> None:
    with pytest.raises(ValueError, match="1,000,000,000,000 cases: expected 10,000,000 at most"):
        study.full_factorial({name: range(1000) for name in "abcd"})


def test_results_come_in_the_order_of_the_cases_on_any_executor(tmp_path: Path) -> None:
    cases = squares(20)
    first = study.run(square, cases, out=tmp_path / "default")
    assert first["square"].to_pylist() == [x**2 for x in range(20) for _ in range(2)]
    assert first["case"].to_pylist() == list(range(40))
    with ThreadPoolExecutor(3) as pool:
        assert study.run(square, cases, out=tmp_path / "threads", executor=pool).equals(first)
    assert study.run(square, cases, out=tmp_path / "processes", executor=study.processes(2)).equals(first)


def test_short_cases_are_batched(tmp_path: Path) -> None:
    study.run(square, squares(2000), out=tmp_path, executor=study.threads(2))
    files = list((tmp_path / "results").glob("part-*/*.parquet"))
    assert len(files) < 100, "4000 cases of a microsecond"


def test_many_workers_get_longer_batches_so_that_one_process_can_hand_them_out() -> None:
    from leadscrew.study._run import MOST_BATCHES_PER_S, batch_size

    for workers in (1, 2, 100, 10_000):
        for each_s in (1e-6, 0.04, 2.0):
            cases = batch_size(each_s, 10_000_000, workers)
            assert cases * each_s >= 0.05 and workers / (cases * each_s) <= MOST_BATCHES_PER_S, (workers, each_s)
    assert batch_size(0.04, 10_000_000, 2) == 3, "few workers: a tenth of a second"


def fails_after(folder: str, case: Mapping[str, Any]) -> dict[str, Any]:
    """As often as the file ``limit`` says it works."""
    counter = Path(folder) / "counter"
    with counter.open("a") as file:
        file.write("x")
    if counter.stat().st_size > int((Path(folder) / "limit").read_text()):
        raise LookupError("no more")
    return {"y": case["x"]}


def test_a_study_that_was_interrupted_goes_on_and_runs_nothing_twice(tmp_path: Path) -> None:
    cases = squares(10)
    function = functools.partial(fails_after, str(tmp_path))
    (tmp_path / "limit").write_text("7")
    with pytest.raises(LookupError):
        study.run(function, cases, out=tmp_path / "out", executor=study.threads(1))
    kept = len(list((tmp_path / "out" / "results").glob("part-*/*.parquet")))
    assert kept > 0
    told: list[study.Progress] = []
    (tmp_path / "limit").write_text("1000")
    before = (tmp_path / "counter").stat().st_size
    table = study.run(function, cases, out=tmp_path / "out", executor=study.threads(1), progress=told.append)
    assert table["y"].to_pylist() == [x for x in range(10) for _ in range(2)]
    assert told[0].found > 0 and told[-1].done == 20
    assert (tmp_path / "counter").stat().st_size - before == 20 - told[0].found


def test_another_function_or_another_program_is_another_study(tmp_path: Path) -> None:
    cases = study.full_factorial({"seed": [1]})
    one = study.Cut("hole.ngc", text=one_hole())
    other = study.Cut("hole.ngc", text=one_hole(1200))
    assert one.fingerprint != other.fingerprint
    rpm = [study.run(cut, cases, out=tmp_path)["rpm_max"].to_pylist()[1] for cut in (one, other, one)]
    assert rpm[0] == rpm[2] and rpm[1] == pytest.approx(1200, rel=0.01)


def test_the_same_case_twice_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="cases 0 and 1 are the same"):
        study.run(square, pa.table({"x": [1, 1], "seed": [1, 1]}), out=tmp_path)


def slow(case: Mapping[str, Any]) -> dict[str, Any]:
    time.sleep(0.1)
    return {"y": float(np.random.default_rng(case["seed"]).normal()), "worker": 0}


def killed_once(marks: str, case: Mapping[str, Any]) -> dict[str, Any]:
    """The worker that first gets case 5 is killed there."""
    mark = Path(marks) / "killed"
    if case["x"] == 5 and case["seed"] == 1 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return slow(case)


@pytest.mark.parametrize("where", ["processes", "dask"])
def test_a_worker_that_is_killed_costs_its_running_cases_and_the_table_is_the_same_to_the_bit(where: str, tmp_path: Path) -> None:
    cases = squares(10)
    undisturbed = study.run(slow, cases, out=tmp_path / "undisturbed")
    (tmp_path / "marks").mkdir()
    function = functools.partial(killed_once, str(tmp_path / "marks"))
    if where == "dask":
        pytest.importorskip("distributed")
    executor = study.processes(2) if where == "processes" else study.dask(workers=2)
    table = study.run(function, cases, out=tmp_path / "killed", executor=executor)
    assert (tmp_path / "marks" / "killed").exists()
    assert table.drop_columns(["hash"]).equals(undisturbed.drop_columns(["hash"]))


def after_a_while(case: Mapping[str, Any]) -> dict[str, Any]:
    time.sleep(0.25)
    return {"y": float(np.random.default_rng(case["seed"]).normal())}


def test_a_study_goes_on_when_its_scheduler_is_restarted(tmp_path: Path) -> None:
    """The scheduler is killed in mid-study, its workers end, and all of them are started again at the same address."""
    pytest.importorskip("distributed")
    import socket

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    running: list[subprocess.Popen[bytes]] = []

    def start() -> None:
        dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"]
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", address, "--nthreads", "2", "--no-nanny", "--no-dashboard"]
        for words in (dask, worker):
            with (tmp_path / "dask.log").open("ab") as log:
                environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parent)}
                running.append(subprocess.Popen(words, stdout=log, stderr=log, env=environment, cwd=tmp_path))

    told: list[study.Progress] = []

    def restart(progress: study.Progress) -> None:
        told.append(progress)
        if progress.done >= 4 and len(running) == 2:
            for process in running:
                process.send_signal(signal.SIGKILL)
                process.wait()
            start()

    cases = squares(10)
    undisturbed = study.run(after_a_while, cases, out=tmp_path / "undisturbed", executor=study.threads(8))
    start()
    try:
        table = study.run(after_a_while, cases, out=tmp_path / "out", executor=study.dask(address), progress=restart)
    finally:
        for process in running:
            process.kill()
            process.wait()
    assert len(running) == 4, "it was restarted"
    assert told[-1].done == 20
    assert table.drop_columns(["hash"]).equals(undisturbed.drop_columns(["hash"]))


def test_a_worker_of_another_version_is_refused_by_name(tmp_path: Path) -> None:
    from leadscrew.study import _run

    with pytest.raises(study.WrongVersion, match=rf"process {os.getpid()}, has leadscrew .*, the study 0.0.9"):
        _run.work(square, [{"x": 1, "seed": 1}], "0.0.9")


def test_a_full_disk_stops_the_study_with_what_is_done_kept(tmp_path: Path) -> None:
    """A limit on the size of files stands for the disk: a write beyond it fails in the same way."""
    script = f"""
import resource, sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
from leadscrew import study
from test_study import square, squares
study.run(square, squares(2), out={str(tmp_path)!r}, executor=study.threads(1))
resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000))
try:
    study.run(lambda case: {{"text": "".join(chr(48 + (i * i * case["seed"] * 7919) % 75) for i in range(20000))}}, squares(2), out={str(tmp_path)!r}, executor=study.threads(1))
except OSError as error:
    print(error)
    sys.exit(5)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 5, done.stderr
    assert "the study stops" in done.stdout and "what is done is kept" in done.stdout
    assert not list(tmp_path.glob("results/part-*/.*")), "half-written files"
    again = study.run(square, squares(2), out=tmp_path)
    assert again.num_rows == 4


def test_a_case_that_ends_in_an_alarm_or_is_refused_is_a_result(tmp_path: Path) -> None:
    cut = study.Cut("hole.ngc", text=one_hole())
    cases = pa.table({"seed": [1, 1], "fault": ["drive-fault spindle at depth 5mm", None]})
    table = study.run(cut, cases, out=tmp_path / "alarm")
    by_case = dict(zip(table["case"].to_pylist(), table["ending"].to_pylist()))
    assert by_case == {0: "alarm", 1: "good"}
    assert {a for c, a in zip(table["case"].to_pylist(), table["alarm"].to_pylist()) if c == 0} != {None}
    refused = study.run(cut, study.full_factorial({"material": ["cheese"]}), out=tmp_path / "refused")
    assert refused["ending"].to_pylist() == ["refused"] and "C45" in refused["reason"].to_pylist()[0]


def test_a_factor_is_a_key_with_its_unit_or_it_is_refused(tmp_path: Path) -> None:
    cut = study.Cut("hole.ngc", text=one_hole())
    for factor, expected in [
        ("plant.axes.z.structure.backlash_mm", "did you mean `backlash_um`"),
        ("colour", "the factor colour is none"),
        ("program.rpm", "has no"),
    ]:
        with pytest.raises(leadscrew.Refused, match=expected):
            cut.arguments({factor: 1})


def test_placeholders_of_the_program_and_the_command_that_repeats_a_case(tmp_path: Path) -> None:
    cut = study.Cut("hole.ngc", text=one_hole().replace("S1000", "S${rpm}").replace("F1000", "F${rpm}"))
    case = {"program.rpm": 1250, PLAY: 9.0, "seed": 4}
    row = cut(case)[1]
    assert row["rpm_max"] == pytest.approx(1250, rel=0.01)
    command = cut.command(case, tmp_path)
    done = subprocess.run(
        [sys.executable, "-m", *command.split(" "), "--format", "json", "-q"], capture_output=True, text=True, check=False
    )
    import json

    again = json.loads(done.stdout)["features"][1]
    assert again["depth_error_um"] == row["depth_error_um"] and again["rpm_max"] == row["rpm_max"]


def test_a_simulated_effect_has_the_size_of_its_closed_form(tmp_path: Path) -> None:
    """A screw that is too long by a share s, with no error at the zero of the work, leaves a hole s·(L − t) too shallow: at the depth
    t = 20 mm a drill of L = 118.5 mm holds the axis L − t above that zero. Whatever the seed."""
    machine = leadscrew.Machine.load("tapping-center")
    cut = study.Cut("hole.ngc", text=one_hole(), machine=machine)
    cases = study.full_factorial({"plant.axes.z.errors.scale_error_ppm": [-400.0, 0.0, 400.0]})
    table = study.run(cut, study.replicated(cases, 2), out=tmp_path)
    holes = table.filter(pc.equal(table["kind"], "hole"))
    found = study.effects(holes, "depth_mm", ["plant.axes.z.errors.scale_error_ppm"])
    assert found[0].effect == pytest.approx(-800e-6 * (118.5 - 20), rel=0.005)


def test_cpk_is_that_of_the_closed_form_within_its_interval() -> None:
    """Gaussian scatter on one linear effect: y = a·x, x ~ N(µ, σ), so Cpk = min(U − aµ, aµ − L)/(3aσ). Over 1000 seeds an
    interval of 95 % covers it in 950 give or take three standard deviations, 21; one of 99 % in at least 95 of the first 100."""
    a, mean, sigma, lower, upper = 0.0985, 20.0, 40.0, -12.0, 16.0
    exact = min(upper - a * mean, a * mean - lower) / (3 * a * sigma)
    one_limit = (upper - a * mean) / (3 * a * sigma)
    two_sided, one_sided, wide = 0, 0, 0
    for seed in range(1, 1001):
        y = a * np.random.default_rng(seed).normal(mean, sigma, 80)
        two_sided += exact in study.capability(y, lower=lower, upper=upper).cpk_interval
        one_sided += one_limit in study.capability(y, upper=upper).cpk_interval
        if seed <= 100:
            wide += exact in study.capability(y, lower=lower, upper=upper, confidence=0.99).cpk_interval
    assert 929 <= two_sided <= 971 and 929 <= one_sided <= 971 and wide >= 95, (two_sided, one_sided, wide)


def test_intervals_are_those_of_the_tables() -> None:
    # Wilson 1927, 10 of 100 at 95 %: 0.0552 to 0.1744 (Newcombe 1998, table I gives the same method for 81/263: 0.2553 to 0.3662)
    interval = study.wilson(81, 263)
    assert [interval.low, interval.high] == pytest.approx([0.2553, 0.3662], abs=5e-5)
    # Montgomery, example 8-4 in the sixth edition: n = 20, Cp = 2.29; 95 %: 1.57 to 3.01
    x = np.linspace(-1, 1, 20)
    x *= 1 / x.std(ddof=1)
    found = study.capability(x, lower=-3 * 2.29, upper=3 * 2.29)
    assert found.cp == pytest.approx(2.29) and found.cp_interval is not None
    assert [found.cp_interval.low, found.cp_interval.high] == pytest.approx([1.57, 3.01], abs=0.01)


def test_effects_and_interactions_are_found() -> None:
    cases = study.full_factorial({"a": [0.0, 1.0, 2.0], "b": [10.0, 20.0]})
    a, b = np.asarray(cases["a"]), np.asarray(cases["b"])
    table = cases.append_column("y", pa.array(3 * a + 0.1 * b + 0.2 * a * b))
    table = pa.concat_tables([table, table])
    found = {effect.factors: effect.effect for effect in study.effects(table, "y", ["a", "b"])}
    # at the middle of the other factor: 2·(3 + 0.2·15) and 10·(0.1 + 0.2·1); together 2·(0.2·1·5)
    assert found[("a",)] == pytest.approx(12) and found[("b",)] == pytest.approx(3)
    assert found[("a", "b")] == pytest.approx(2)


def test_too_few_values_or_no_scatter_are_no_capability() -> None:
    for values, limits, expected in [
        ([1.0], {"upper": 2.0}, "at least 2"),
        ([1.0, 1.0], {"upper": 2.0}, "without scatter"),
        ([1.0, 2.0], {}, "a lower or an upper limit"),
        ([1.0, float("nan")], {"upper": 2.0}, "finite"),
    ]:
        with pytest.raises(ValueError, match=expected):
            study.capability(values, **limits)
