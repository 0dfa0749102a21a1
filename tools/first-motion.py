#!/usr/bin/env python3
"""Says how long a control takes from cycle start to the first motion, and from a feed hold, an override and a stop to the next.

    python tools/first-motion.py PROGRAM... [--machine M] [--leadscrew BIN]

Serves a control in real time on a simulated machine, loads each program, shifts the work by a touch-off (which changes what it
was proved for) and starts it, once right after that, which waits until it is proved anew, and once when it is. Times are those of
the wall, from the request until a picture shows that an axis has moved; a picture is made every 20 ms. One that is not done within
an hour ends the measurement.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path

PORT = 8391
BASE = f"http://127.0.0.1:{PORT}/api/v1"
MOST_S = 3600.0
POLL_S = 0.002
MOVED_MM = 1e-4


def call(path: str, body: dict[str, object] | None = None) -> dict:
    data = None if body is None else json.dumps(body).encode()
    try:
        with urllib.request.urlopen(f"{BASE}/{path}", data, timeout=MOST_S) as answer:
            return json.load(answer)
    except urllib.error.HTTPError as error:
        raise SystemExit(f"{path} {body}: {error.read().decode()}") from error


def ask(request: str, **fields: object) -> dict:
    return call("request", {"request": request, **fields})


def until(what: str, is_so: Callable[[dict], bool]) -> float:
    """When it is so."""
    begun = time.monotonic()
    while time.monotonic() - begun < MOST_S:
        if is_so(call("status")):
            return time.monotonic()
        time.sleep(POLL_S)
    raise SystemExit(f"{what}: not within {MOST_S:.0f} s")


def places(status: dict) -> list[float]:
    return [axis["machine"] for axis in status["axes"]]


def moves() -> Callable[[dict], bool]:
    """Whether an axis has moved since now."""
    before = places(call("status"))
    return lambda status: any(abs(a - b) > MOVED_MM for a, b in zip(places(status), before, strict=True))


def stands() -> None:
    """Until nothing has moved for a tenth of a second."""
    last, since = places(call("status")), time.monotonic()
    while time.monotonic() - since < 0.1:
        now = places(call("status"))
        if now != last:
            last, since = now, time.monotonic()


def after(request: str, **fields: object) -> float:
    """From the request to the next motion, s."""
    moved, begun = moves(), time.monotonic()
    ask(request, **fields)
    return until(request, moved) - begun


def stop() -> None:
    ask("stop")
    until("stopped", lambda status: status["execution"] in ("STOPPED", "PROGRAM_STOPPED", "PROGRAM_COMPLETED"))
    stands()


def shift() -> None:
    """What the program was proved for changes by a tenth of a millimetre: it is proved anew half a second after the last request."""
    work = next(axis["work"] for axis in call("status")["axes"] if axis["letter"] == "Z")
    ask("touch_off", axis="Z", at_mm=work + 0.1)


def measured(program: str) -> str:
    begun = time.monotonic()
    ask("load", program=program)
    loaded = time.monotonic() - begun
    proved = 1.0 + 2.0 * loaded
    shift()
    waited = after("start")
    time.sleep(0.2)
    stop()
    shift()
    time.sleep(proved)
    start = after("start")
    time.sleep(0.5)
    ask("feed_hold")
    stands()
    resumed = after("resume")
    ask("feed_override", percent=0)
    stands()
    overridden = after("feed_override", percent=100)
    stop()
    time.sleep(proved)
    again = after("start")
    stop()
    times = (waited, start, resumed, overridden, again)
    return f"| {program} | {loaded:.1f} | " + " | ".join(f"{t:.3f}" for t in times) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", nargs="+", type=Path)
    parser.add_argument("--machine", default="bench-xyz-jerk20")
    parser.add_argument("--leadscrew", default="target/release/leadscrew")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for program in args.programs:
            shutil.copy(program, folder)
        serve = [args.leadscrew, "serve", "--machine", args.machine, "--port", str(PORT), "--programs", folder, "--real-time"]
        control = subprocess.Popen(serve, stdout=subprocess.DEVNULL)
        try:
            while True:
                try:
                    urllib.request.urlopen(f"{BASE}/status", timeout=1).close()
                    break
                except urllib.error.URLError:
                    if control.poll() is not None:
                        raise SystemExit("the control has ended") from None
                    time.sleep(0.05)
            ask("power", on=True)
            until("the drives are ready", lambda status: status["is_ready"])
            ask("home")
            time.sleep(0.5)
            until("homed", lambda status: all(axis["is_homed"] for axis in status["axes"]))
            print("| program | loaded within s | start right after a touch-off | start | after a feed hold | after an override of 0 % | after a stop |")
            print("|---|---|---|---|---|---|---|")
            for program in args.programs:
                print(measured(program.name), flush=True)
        finally:
            control.terminate()
            control.wait()


if __name__ == "__main__":
    main()
