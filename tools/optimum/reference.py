#!/usr/bin/env python3
"""How near to the optimum is the law of time? reference.py [--step MM] [PROGRAM ...]

Solves for each program's joined path the same problem slowly: the squared speed at each place of a grid is the unknown, the axes'
speeds and accelerations are convex bounds on it (as TOPP-RA has them), the time is a convex goal. Jerk, q'u + 3q''a + q'''b
<= J/sqrt(b), is made convex by the tangent of 1/sqrt(b), which keeps it, at the solution before, again and again until the time
stands still. Needs numpy and cvxpy. Prints a table: our time, the reference's, and the ratio, without jerk and with 20 m/s3.
"""
import argparse, math, pathlib, subprocess, sys
import cvxpy as cp, numpy as np

SPEED, ACCEL = 200.0, 1000.0  # mm/s, mm/s2, of every axis
HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
UNIT = 1e3  # of the squared speed, for the solver's sake


def grid(program, tolerance, jerk, step):
    words = [str(word) for word in (program, tolerance, jerk, step)]
    lines = subprocess.run([ROOT / "target/release/examples/grid", *words], capture_output=True, text=True, check=True).stdout.splitlines()
    rows = np.array([[float(word) for word in line.split()] for line in lines[1:]])
    return float(lines[0]), rows[:, 0], rows[:, 1], rows[:, 2:].reshape(len(rows), 3, 3, 3)


def solved(goal, bounds):
    problem = cp.Problem(cp.Minimize(goal), bounds)
    problem.solve(solver=cp.CLARABEL)
    if problem.status not in ("optimal", "optimal_inaccurate"):
        raise RuntimeError(f"the solver says {problem.status}")
    return problem.value


def optimum(h, feed, q, jerk):
    n = len(h)
    slope = np.abs(q[..., 0]).max(axis=(1, 2))
    cap = np.minimum(feed, SPEED / np.maximum(slope, 1e-12)) ** 2
    cap = np.minimum(np.append(cap, cap[-1]), np.append(cap[0], cap)) / UNIT
    b = cp.Variable(n + 1)
    a = cp.multiply(UNIT / (2 * h), b[1:] - b[:-1])
    bounds = [b >= 0, b <= cap, b[0] == 0, b[n] == 0]
    for axis in range(3):
        for place, there in ((0, b[:-1]), (1, (b[1:] + b[:-1]) / 2), (2, b[1:])):
            one, two = q[:, place, axis, 0] / ACCEL, q[:, place, axis, 1] / ACCEL
            if np.abs([one, two]).max() > 1e-12:
                bounds.append(cp.abs(cp.multiply(one, a) + cp.multiply(UNIT * two, there)) <= 1)
    root = cp.sqrt(b)
    time = cp.sum(cp.multiply(2 * h / math.sqrt(UNIT), cp.inv_pos(root[1:] + root[:-1])))
    best = solved(time, bounds)
    if math.isinf(jerk):
        return best
    u = cp.multiply(2 / (h[1:] + h[:-1]), a[1:] - a[:-1])
    mean = (a[1:] + a[:-1]) / 2
    for _ in range(12):
        known = np.maximum(b.value[1:-1], 1e-6) * UNIT
        room = 1.5 - cp.multiply(0.5 * UNIT / known, b[1:-1])  # over 1/sqrt(known)
        third = []
        for axis in range(3):
            for stretch, place in ((slice(0, n - 1), 2), (slice(1, n), 0)):
                one, two, three = (q[stretch, place, axis, k] / jerk for k in range(3))
                if np.abs([one, two, three]).max() > 1e-12:
                    load = cp.multiply(one, u) + cp.multiply(3 * two, mean) + cp.multiply(UNIT * three, b[1:-1])
                    third.append(cp.multiply(np.sqrt(known), cp.abs(load)) <= room)
        before, best = best, solved(time, bounds + third)
        if abs(before - best) < 2e-4 * best:
            break
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--step", type=float, default=0.05, help="of the grid, mm (0.05)")
    parser.add_argument("programs", nargs="*", type=pathlib.Path, help="G0 and G1; all of tools/optimum/paths if left out")
    words = parser.parse_args()
    subprocess.run(["cargo", "build", "--release", "--quiet", "--workspace", "--example", "grid"], cwd=ROOT, check=True)
    print("| path | P mm | ours s | reference s | ratio | ours, 20 m/s³ | reference | ratio |\n|---|---|---|---|---|---|---|---|")
    for program in words.programs or sorted((HERE / "paths").glob("*.ngc")):
        tolerance = {"real4": 0.1, "real5": 0.1, "real6": 0.1, "real7": 0.001}.get(program.stem, 0.01)
        cells = [program.stem, f"{tolerance:g}"]
        for jerk in (math.inf, 20.0):
            ours, *path = grid(program.resolve(), tolerance, jerk, words.step)
            try:
                best = optimum(*path, jerk * 1e3)
                cells += [f"{ours:.3f}", f"{best:.3f}", f"{ours / best:.3f}"]
            except (RuntimeError, cp.SolverError) as why:
                cells += [f"{ours:.3f}", f"({why})", "–"]
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
