"""SOEM, by `pysoem`, and KickCAT on the emulated EtherCAT devices: run by tools/ethercat-masters, in its namespace.

A process passes frames between one end of a veth pair and the devices on pipes; the masters have the other end, one after the other.
"""
import multiprocessing
import os
import socket
import struct
import subprocess
import sys
import time

DRIVES = 6
ETHERCAT = 0x88A4


def bridge(program, interface):
    """Passes frames from a network card to the devices and back."""
    wire = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETHERCAT))
    wire.bind((interface, ETHERCAT))
    devices = subprocess.Popen([program, str(DRIVES)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
    while True:
        frame, address = wire.recvfrom(2048)
        if address[2] == socket.PACKET_OUTGOING:
            continue
        os.write(devices.stdin.fileno(), struct.pack("<H", len(frame)) + frame)
        (length,) = struct.unpack("<H", devices.stdout.read(2))
        answer = b""
        while len(answer) < length:
            answer += devices.stdout.read(length - len(answer))
        wire.send(answer)


def soem(interface):
    import pysoem

    master = pysoem.Master()
    master.open(interface)
    found = master.config_init()
    assert found == DRIVES + 2, f"{found} devices"
    drives = master.slaves[1 : 1 + DRIVES]
    names = [device.name for device in master.slaves]
    print("soem:", names)

    def configure(position):
        drive = master.slaves[position]
        # by complete access, with the count in 16 bits
        drive.sdo_write(0x1C12, 0, struct.pack("<HH", 1, 0x1600), True)
        drive.sdo_write(0x1C13, 0, struct.pack("<HH", 1, 0x1A00), True)
        assert drive.sdo_read(0x1C12, 0, ca=True)[:4] == struct.pack("<HH", 1, 0x1600)
        drive.sdo_write(0x6060, 0, struct.pack("<b", 8))
        assert drive.sdo_read(0x1008, 0).rstrip(b"\0") == b"Drive"

    for drive in drives:
        drive.config_func = configure
    size = master.config_map()
    print("soem: process image of", size, "bytes")
    clocks = master.config_dc()
    print("soem: distributed clocks", clocks)
    assert master.state_check(pysoem.SAFEOP_STATE, 5_000_000) == pysoem.SAFEOP_STATE, states(master)
    for drive in drives:
        drive.dc_sync(True, 4_000_000)
    # cyclic data from here on
    for _ in range(50):
        cycle(master)
    master.state = pysoem.OP_STATE
    master.write_state()
    for _ in range(400):
        cycle(master)
        if master.state_check(pysoem.OP_STATE, 1_000) == pysoem.OP_STATE:
            break
    assert master.state == pysoem.OP_STATE, states(master)
    print("soem: OP, working counter", cycle(master), "of", master.expected_wkc)
    assert cycle(master) == master.expected_wkc
    for control in (0x80, 0, 6, 7, 15):
        for _ in range(10):
            for drive in drives:
                _, position = struct.unpack("<Hi", drive.input[:6])
                drive.output = struct.pack("<Hi", control, position)
            cycle(master)
    status = [struct.unpack("<Hi", drive.input[:6])[0] for drive in drives]
    assert all(word & 0x6F == 0x27 for word in status), [hex(word) for word in status]
    for step in range(1, 201):
        for at, drive in enumerate(drives):
            drive.output = struct.pack("<Hi", 15, 100 * step * (at + 1))
        master.slaves[-1].output = bytes([step & 0xFF])
        cycle(master)
    for _ in range(5):
        cycle(master)
    positions = [struct.unpack("<Hi", drive.input[:6])[1] for drive in drives]
    print("soem: positions", positions)
    assert positions == [20_000 * (at + 1) for at in range(DRIVES)]
    master.state = pysoem.INIT_STATE
    master.write_state()
    master.close()


def kickcat(interface):
    import kickcat as kc

    link = kc.create_link(interface, "")
    link.set_timeout(0.02)
    bus = kc.Bus(link)
    bus.init(0.1)
    assert len(bus.slaves()) == DRIVES + 2, len(bus.slaves())
    drive = bus.slaves()[1]
    assert bus.read_sdo(drive, 0x1018, 1, kc.Access.PARTIAL, 4, 0.5)[:4] == struct.pack("<I", 0x0E5C)
    print("kickcat:", bus.read_object_description(drive, 0x6040), bus.read_entry_description(drive, 0x6041, 0))
    bus.create_mapping()
    bus.request_state(kc.State.SAFE_OP)
    bus.wait_for_state(kc.State.SAFE_OP, 1.0)
    drives = bus.slaves()[1 : 1 + DRIVES]
    assert [drive.output_size for drive in drives] == [6] * DRIVES
    targets = [struct.pack("<Hi", 0, 0)] * DRIVES

    def exchange(times):
        for _ in range(times):
            for drive, target in zip(drives, targets):
                drive.set_output_bytes(target)
            bus.process_data()
            time.sleep(0.002)

    def feedback():
        return [struct.unpack("<Hi", drive.input_data[:6]) for drive in drives]

    bus.request_state(kc.State.OPERATIONAL)
    for _ in range(500):
        exchange(1)
        if all(bus.get_state(slave) == kc.State.OPERATIONAL for slave in bus.slaves()):
            break
    assert all(bus.get_state(slave) == kc.State.OPERATIONAL for slave in bus.slaves())
    for control in (0x80, 0, 6, 7, 15):
        for _ in range(10):
            targets = [struct.pack("<Hi", control, position) for _, position in feedback()]
            exchange(1)
    assert all(status & 0x6F == 0x27 for status, _ in feedback()), feedback()
    bus.request_state(kc.State.INIT)
    print("kickcat: OP, all drives enabled")


def cycle(master):
    master.send_processdata()
    counter = master.receive_processdata(20_000)
    time.sleep(0.004)
    return counter


def states(master):
    master.read_state()
    return [(device.name, hex(device.state), hex(device.al_status)) for device in master.slaves]


for command in (
    "ip link add ec0 type veth peer name ec1",
    "ip link set ec0 up",
    "ip link set ec1 up",
):
    subprocess.run(command.split(), check=True)
devices = multiprocessing.Process(target=bridge, args=(sys.argv[1], "ec1"), daemon=True)
devices.start()
time.sleep(1)
for master in (soem, kickcat):
    master("ec0")
print("ethercat-masters: 2 passed, 0 failed")
devices.terminate()
