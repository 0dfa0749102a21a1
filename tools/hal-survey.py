#!/usr/bin/env python3
"""Imports all of LinuxCNC's sample configurations and counts what no line of the import names.

tools/hal-survey.py LEADSCREW [FOLDER]: for each INI file of the folder (that of Debian's package) it runs
`leadscrew machine import`, reads INI and HAL files by itself, and looks for each pin of LinuxCNC's own components that is
wired, and for each key, in what was said. Exit code 1: something is named in no line.
"""
import collections
import os
import re
import subprocess
import sys
import tempfile

SAMPLES = "/usr/share/doc/linuxcnc/examples/sample-configs"
LIBRARY = "/usr/share/linuxcnc/hallib"
OWN = re.compile(r"(motion|joint|axis|spindle|iocontrol|halui|ini)\.")
INCLUDE = "#INCLUDE"


def text_of(path):
    with open(path, errors="replace") as file:
        return file.read().replace("\\\n", " ").splitlines()


def found(folder, name):
    """A file beside the INI file, or in the library."""
    own = [] if name.startswith("LIB:") else [os.path.join(folder, name)]
    name = name.removeprefix("LIB:")
    return next((path for path in [*own, os.path.join(LIBRARY, name)] if os.path.isfile(path)), None)


def keys_of(path, folder, section="", depth=0):
    """(section, key, value) of an INI file and of what it includes."""
    keys = []
    for line in text_of(path):
        line = line.strip()
        if line.startswith(INCLUDE) and depth < 8:
            more = found(folder, line.removeprefix(INCLUDE).strip())
            if more:
                keys += keys_of(more, folder, section, depth + 1)
        elif not line or line[0] in "#;":
            continue
        elif line[0] == "[":
            section = line[1:].split("]")[0].strip()
        elif "=" in line:
            key, value = line.split("=", 1)
            keys.append((section, key.strip(), value.strip()))
    return keys


def pins_of(lines, folder, values, depth=0):
    """Pins of LinuxCNC's own components that lines of HAL files wire or set."""
    pins = set()
    for line in lines:
        words = line.split("#")[0].replace('"', "").split()
        if not words:
            continue
        if words[0] == "source" and len(words) > 1 and depth < 8:
            path = found(folder, words[1])
            pins |= pins_of(text_of(path), folder, values, depth + 1) if path else set()
        candidates = []
        if words[0] in ("net", "linksp"):
            candidates = words[2:]
        elif words[0] == "linkps":
            candidates = words[1:2]
        elif words[0] == "linkpp":
            candidates = words[1:3]
        elif words[0] == "setp":
            candidates = words[1:2]
        for word in candidates:
            word = re.sub(r"\[(\w+)\]\(?(\w+)\)?", lambda of: values.get(of.groups(), of.group()), word)
            if OWN.match(word):
                pins.add(word)
    return pins


def named(said, word):
    return re.search(r"(?<![\w.-])" + re.escape(word) + r"(?![\w.-])", said) is not None


def main():
    leadscrew, folder = sys.argv[1], (sys.argv[2:] or [SAMPLES])[0]
    counts, lost, kinds = collections.Counter(), [], collections.Counter()
    files = sorted(
        os.path.join(place, name) for place, _, names in os.walk(folder) for name in names if name.endswith(".ini")
    )
    with tempfile.TemporaryDirectory() as out:
        for number, ini in enumerate(files):
            counts["read"] += 1
            run = [leadscrew, "machine", "import", ini, "--out", os.path.join(out, f"{number}.toml")]
            done = subprocess.run(run, capture_output=True, text=True, env={**os.environ, "NO_COLOR": "1"})
            said = done.stdout + done.stderr
            counts["written"] += done.returncode == 0
            kinds.update(line[:8].strip() for line in said.splitlines())
            beside = os.path.dirname(ini)
            keys = keys_of(ini, beside)
            values = {(section, key): value for section, key, value in reversed(keys)}
            lines = [value for section, key, value in keys if (section, key) == ("HAL", "HALCMD")]
            for section, key, value in keys:
                if section == "HAL" and key in ("HALFILE", "POSTGUI_HALFILE") and value:
                    path = found(beside, value.split()[0])
                    lines += [f"source {value.split()[0]}"] if path and not path.endswith(".tcl") else []
            pins = pins_of(lines, beside, values)
            counts["pins"] += len(pins)
            counts["keys"] += len(keys)
            lost += [f"{ini}: pin {pin}" for pin in sorted(pins) if not named(said, pin)]
            lost += [f"{ini}: [{s}]{k}" for s, k in sorted({key[:2] for key in keys}) if f"[{s}]{k}" not in said]
    print(f"{counts['read']} configurations read, {counts['written']} machine files written")
    print(f"{counts['pins']} wired or set pins of LinuxCNC's own components, {counts['keys']} keys; "
          f"{len(lost)} of them in no line")
    for kind in ("taken", "guessed", "missing", "rewire", "not read", "safety", "wrong"):
        print(f"{kinds[kind]:7} {kind}")
    print("\n".join(lost[:40]))
    return 1 if lost else 0


sys.exit(main())
