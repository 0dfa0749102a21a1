"""States and transitions of CiA 402 as the Python package `canopen` has them, as a table for the tests.

    python3 tools/cia402-states.py > crates/ethercat/tests/cia402-states.txt
"""
import pathlib
import subprocess
import sys

VERSION = "2.4.1"
root = pathlib.Path(__file__).resolve().parent.parent
venv = root / "target/cia402-venv"
if pathlib.Path(sys.prefix) != venv:
    python = venv / "bin/python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", venv], check=True)
        subprocess.run([python, "-m", "pip", "-q", "install", f"canopen=={VERSION}"], check=True)
    sys.exit(subprocess.run([python, __file__]).returncode)

from canopen.profiles.p402 import State402


def state(word):
    """The one state whose mask fits a status word."""
    names = [name for name, (mask, bits) in State402.SW_MASK.items() if word & mask == bits]
    assert len(names) <= 1, (word, names)
    return names[0] if names else "NONE"


# all 65,536 words: the state is one of the lowest seven bits
assert all(state(word) == state(word & 0x7F) for word in range(0x10000))
print(f"# canopen {VERSION}, canopen.profiles.p402.State402; made by tools/cia402-states.py")
for word in range(0x80):
    print(f"status {word:02X} {state(word)}")
for (before, after), control in State402.TRANSITIONTABLE.items():
    if before != "START":
        print(f"control {control:04X} {before} > {after}")
