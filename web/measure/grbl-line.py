"""A line on which a controller answers as Grbl 1.1 does: its position is the moment, in milliseconds of the day (UTC).

It prints the device that a sender opens, and answers until it is ended.
"""
import os
import pty
import time
import tty

master, slave = pty.openpty()
tty.setraw(slave)
print(os.ttyname(slave), flush=True)
os.write(master, b"\r\nGrbl 1.1h ['$' for help]\r\n")
line = b""
while True:
    for byte in os.read(master, 256):
        if byte == ord("?"):
            moment = time.time() * 1000 % 86_400_000
            os.write(master, f"<Idle|MPos:{moment:.3f},0.000,0.000|FS:0,0>\r\n".encode())
        elif byte == 0x18:
            os.write(master, b"\r\nGrbl 1.1h ['$' for help]\r\n")
        elif byte == ord("\n"):
            os.write(master, b"[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\r\nok\r\n" if line == b"$G" else b"ok\r\n")
            line = b""
        else:
            line = (line + bytes([byte])).strip()[-64:]
