#!/usr/bin/python3
"""Leads LinuxCNC's own control through a program, within a HAL session.

hal-linuxcnc.py INI PROGRAM X Y Z LIMIT

X Y Z is the work offset G54 of the program, LIMIT the most seconds that it may take: then it is aborted, and that is said. It is started by Debian's own Python, for which
LinuxCNC brings its module.
"""
import sys
import time

import linuxcnc


def until(what, limit, status, sentence):
    end = time.monotonic() + limit
    while True:
        status.poll()
        if what():
            return
        if time.monotonic() > end:
            sys.exit(f"LinuxCNC: {sentence} within {limit:.0f} s")
        time.sleep(0.02)


def main():
    ini, program = sys.argv[1:3]
    offset, limit = sys.argv[3:6], float(sys.argv[6])
    linuxcnc.nmlfile = "/usr/share/linuxcnc/linuxcnc.nml"
    end = time.monotonic() + 10
    while True:
        try:
            status, command, errors = linuxcnc.stat(), linuxcnc.command(), linuxcnc.error_channel()
            status.poll()
            break
        except linuxcnc.error:
            if time.monotonic() > end:
                raise
            time.sleep(0.1)
    command.state(linuxcnc.STATE_ESTOP_RESET)
    until(lambda: status.task_state != linuxcnc.STATE_ESTOP, 10, status, "its emergency stop is not reset")
    command.state(linuxcnc.STATE_ON)
    until(lambda: status.task_state == linuxcnc.STATE_ON, 10, status, "it does not switch on")
    command.mode(linuxcnc.MODE_MANUAL)
    command.wait_complete()
    command.home(-1)
    until(lambda: all(status.homed[:3]), 10, status, "it is not homed")
    command.mode(linuxcnc.MODE_MDI)
    command.wait_complete()
    command.mdi("G10 L2 P1 X{} Y{} Z{}".format(*offset))
    command.wait_complete(10)
    command.mode(linuxcnc.MODE_AUTO)
    command.wait_complete()
    command.program_open(program)
    command.auto(linuxcnc.AUTO_RUN, 0)
    until(lambda: status.interp_state != linuxcnc.INTERP_IDLE, 10, status, "its program does not start")
    end = time.monotonic() + limit
    while status.interp_state != linuxcnc.INTERP_IDLE:
        if time.monotonic() > end:
            print(f"LinuxCNC: its program is not over within {limit:.0f} s: it waits in line {status.motion_line}")
            command.abort()
            break
        time.sleep(0.02)
        status.poll()
    while said := errors.poll():
        print(f"LinuxCNC: {said[1].strip()}")
    command.state(linuxcnc.STATE_OFF)
    command.wait_complete()


if __name__ == "__main__":
    main()
