#!/usr/bin/env python3
"""Holds the capability of simulated studies against the closed form: how often its interval has the exact Cpk in it.

    python tools/study-coverage.py --studies 100 --holes 40

The screw of Z is too long by a share s, drawn for each hole from a Gaussian distribution, and has no error at the zero of the
work. A hole of depth t with a drill of length L then comes out deeper by -s·(L - t), whatever else the machine does: so the
exact Cpk is min(U - m, m - Lo) / (3·(L - t)·σ), m being the mean. What the machine does without that error is measured once.
An interval of 95 % has it in 95 of 100 studies, give or take.
"""

from __future__ import annotations

import argparse
import tempfile

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from leadscrew import study

DEPTH, DRILL = 20.0, 118.5
HOLE = """G21 G90 G54 G17 G94
T2 M6
G43 H2
S3000 M3
G0 X0 Y0 Z20
G99 G81 X0 Y0 Z-20 R5 F300
G80
G0 Z50
M2
"""
SCREW = "plant.axes.z.errors.scale_error_ppm"
MEAN, SIGMA = 20.0, 40.0
LIMIT_UM = 12.0


def main() -> None:
    asked = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    asked.add_argument("--studies", type=int, default=100)
    asked.add_argument("--holes", type=int, default=40)
    args = asked.parse_args()
    drawn = [np.random.default_rng(seed).normal(MEAN, SIGMA, args.holes) for seed in range(1, args.studies + 1)]
    cases = pa.table({SCREW: np.concatenate([[0.0], *drawn]), "seed": np.ones(1 + args.studies * args.holes, dtype=np.int64)})
    with tempfile.TemporaryDirectory() as out:
        table = study.run(study.Cut("hole.ngc", text=HOLE), cases, out=out, executor=study.processes(2))
    holes = table.filter(pc.equal(table["kind"], "hole"))
    errors = (np.asarray(holes["depth_mm"]) - DEPTH) * 1e3
    assert len(errors) == cases.num_rows, "a hole is missing"
    without, errors = errors[0], errors[1:].reshape(args.studies, args.holes)

    way_mm = DRILL - DEPTH
    mean, sigma = without - MEAN * way_mm * 1e-3, SIGMA * way_mm * 1e-3
    exact = min(LIMIT_UM - mean, mean + LIMIT_UM) / (3 * sigma)
    found = [study.capability(errors[k], lower=-LIMIT_UM, upper=LIMIT_UM) for k in range(args.studies)]
    hits = sum(one.cpk_interval.low <= exact <= one.cpk_interval.high for one in found)
    print(f"exact Cpk {exact:.4f}; {args.studies} studies of {args.holes} holes: median {np.median([one.cpk for one in found]):.4f}")
    print(f"the interval of 95 % has the exact one in it in {hits} of {args.studies}")


if __name__ == "__main__":
    main()
