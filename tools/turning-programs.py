"""Random turning programs of ordinary shapes: faced, turned, chamfered, rounded, retracted as shops do.

Each is safe by its own geometry (it only goes where it has cut before, or where the bar is not), so
`leadscrew run` must neither refuse it nor end it with an alarm; what it says otherwise is printed.

    python3 tools/turning-programs.py COUNT [SEED [LEADSCREW]]
"""
import random
import subprocess
import sys
import tempfile
from pathlib import Path

HOME = Path(__file__).resolve().parent.parent
TOOLS = HOME / "crates/leadscrew/tests/attacks/turning.toml"
MACHINES = ("lathe", "turning-center")


def program(rng, radius):
    """A program and its story."""
    unit = rng.choice(("G21", "G21", "G20"))
    scale = 1.0 if unit == "G21" else 25.4
    places = 3 if unit == "G21" else 5
    num = lambda value: f"{value / scale:.{places}f}"
    far = f"-{num(radius)}"
    lines = [
        f"(STOCK X{far} Y{far} Z-{num(90)} X{num(radius)} Y{num(radius)} Z0)",
        f"{unit} G18 G90 G94 G8",
    ]
    story = []
    front, tool, outer = 0.0, rng.choice((1, 2)), radius

    def call(number):
        speed = rng.choice((500, 800, 1200, 2000, 3000))
        lines.extend((f"T{number} M6", f"G43 H{number}", f"S{speed} M3", f"G0 X{num(radius + 10)} Y0 Z{num(10)}"))
        return speed

    speed = call(tool)
    feed = lambda per_turn: f"F{num(speed * per_turn)}"
    g0 = lambda **to: lines.append("G0 " + " ".join(f"{axis}{num(value)}" for axis, value in to.items()))
    g1 = lambda per_turn, **to: lines.append("G1 " + " ".join(f"{axis}{num(value)}" for axis, value in to.items()) + " " + feed(per_turn))
    retract = lambda r, z: rng.choice((
        lambda: (g0(X=radius + 2), g0(Z=2)),
        lambda: g0(X=radius + 2, Z=z + 1),
        lambda: (g0(X=r + 0.5, Z=z + 0.5), g0(X=radius + 2), g0(Z=2)),
        lambda: g1(rng.uniform(0.1, 0.5), X=radius + 1),
    ))()
    if rng.random() < 0.6:
        front = -rng.uniform(0.1, 1.5)
        g0(X=radius + 1.5, Z=front)
        g1(rng.uniform(0.05, 0.3), X=-0.9)
        g0(Z=front + 2) if rng.random() < 0.7 else (g0(Z=front + 0.5), g0(X=radius + 2))
        g0(X=radius + 2, Z=3)
        story.append(f"faced by {-front:.2f}")
    depths = rng.randrange(0, 4)
    length = rng.uniform(6, 40)
    for _ in range(depths):
        outer -= rng.uniform(0.2, 1.6)
        g0(X=radius + 2)
        g0(Z=front + 2)
        g0(X=outer)
        g1(rng.uniform(0.05, 0.35), Z=-length)
        retract(outer, -length)
        story.append(f"turned to {2 * outer:.2f} over {length:.1f}")
        length -= rng.uniform(0.0, 2.0)
        if length < 3:
            break
    if rng.random() < 0.5:
        tool = 2
        speed = call(tool)
    chamfer = rng.uniform(0.3, 2.0)
    steep = rng.uniform(0.6, 1.7)
    g0(X=radius + 2, Z=front + 3)
    kind = rng.choice(("chamfer", "chamfer", "chamfer", "radius"))
    if kind == "chamfer":
        lead = 0.5
        g0(X=outer - chamfer - lead, Z=front + lead * steep)
        g1(rng.uniform(0.03, 0.3), X=outer + 0.3, Z=front - (chamfer + 0.3) * steep)
        end = front - (chamfer + 0.3) * steep
    else:
        g0(X=outer - chamfer, Z=front + 0.5)
        g1(rng.uniform(0.03, 0.2), Z=front)
        lines.append(f"G3 X{num(outer)} Z{num(front - chamfer)} I0 K{num(-chamfer)} {feed(rng.uniform(0.03, 0.2))}")
        end = front - chamfer
        if rng.random() < 0.5:
            g1(0.1, Z=end - rng.uniform(0.2, 1.0))
    story.append(f"{kind} of {chamfer:.2f}, {steep:.2f}")
    retract(outer, end)
    lines.extend((f"G0 X{num(radius + 10)}", f"G0 Z{num(50)}", "M5", "M2"))
    return "\n".join(lines) + "\n", f"T{tool} {unit} " + ", ".join(story)


def main():
    count = int(sys.argv[1])
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    leadscrew = sys.argv[3] if len(sys.argv) > 3 else str(HOME / "target/debug/leadscrew")
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for k in range(count):
            rng = random.Random(1000 * seed + k)
            machine = rng.choice(MACHINES)
            text, story = program(rng, rng.choice((8.0, 10.0, 10.0, 14.0, 20.0)))
            path = Path(folder) / "part.ngc"
            path.write_text(text)
            run = subprocess.run(
                [leadscrew, "run", path, "--machine", machine, "--dialect", "linuxcnc", "--tools", TOOLS, "--seed", str(1 + k % 7)],
                capture_output=True, text=True, check=False, cwd=folder)
            found[run.returncode] = found.get(run.returncode, 0) + 1
            if run.returncode > 1:
                said = [line for line in (run.stderr + run.stdout).splitlines() if "error[" in line or "alarm" in line.lower()]
                print(f"{1000 * seed + k} {machine}: {story}: {run.returncode} {said[:2]}", flush=True)
                Path(f"/tmp/turning-{1000 * seed + k}.ngc").write_text(text)
    print(f"{count} programs, by exit code: {dict(sorted(found.items()))}")


main()
