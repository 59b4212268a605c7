# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""A whole transaction, the bus and the host port."""

from harness import wave
from protocol import frames
from protocol.defs import F8E1, FC, Space, bus_address

from .device import OWN, mask
from .lab import BIT_115200, BITS, CLK_HZ, FLOOR_T35, WORDS, number, table
from .requests import BASIC, FIFO_COUNT, read_records, read_write, write_records
from .transmission import host_access


def transaction(lab):
    """Table `transaction`: 125 registers at 115200 baud."""
    device = lab(0, 1)
    device.setup(BIT_115200)
    device.reset(FLOOR_T35 + 1000)
    frame = frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 125))
    begin = device.now
    request_end, log = device.request(frame, FLOOR_T35 + 256 * 11 * BIT_115200 + 2000, log=mask("txd de"))
    answer = wave.decode(log.edges("txd"), F8E1, BIT_115200)
    assert len(answer.data) == 255
    pieces = [
        ("request, 8 characters", request_end - begin, 8 * 11 * BIT_115200),
        ("silence before the answer", answer.start - request_end, FLOOR_T35),
        ("answer, 255 characters", answer.end - answer.start, 255 * 11 * BIT_115200),
        ("silence before the next request", FLOOR_T35, FLOOR_T35),
    ]
    pieces.append(("total", *(sum(piece[i] for piece in pieces) for i in (1, 2))))
    rows = [
        [name, number(got), *(f"{n / CLK_HZ * 1e3:.3f}" for n in (got, line)), f"{100 * (got / line - 1):+.2f} %"]
        for name, got, line in pieces
    ]
    return {"transaction": table(["part", "clocks", "ms", "ms the line needs", "more"], rows)}


# ------------------------------------------------------------------ bus and host port


def to_grant(device, pdu):
    """Send a request and run to the clock in which the bank is asked."""
    device.reset()
    edges, end = device.wave(frames.adu(OWN, pdu))
    device.run(end + 60 * device.bit_time + 5000, edges, mask("grant_req"))
    assert device.peek().grant_req


BUS_REQUESTS = (
    ("FC 03, 1 register", frames.read(FC.READ_HOLDINGS, 0, 1)),
    ("FC 03, 125 registers", frames.read(FC.READ_HOLDINGS, 0, 125)),
    ("FC 18, 31 entries", frames.read_fifo(FIFO_COUNT)),
    ("FC 10, 1 register", frames.write_registers(0, WORDS[:1])),
    ("FC 10, 123 registers", frames.write_registers(0, WORDS[:123])),
    ("FC 01, 1 coil", frames.read(FC.READ_COILS, 0, 1)),
    ("FC 01, 2000 coils", frames.read(FC.READ_COILS, 0, 2000)),
    ("FC 0F, 1968 coils", frames.write_coils(0, BITS[:1968])),
    ("FC 16", frames.mask_write(0, 1, 2)),
    ("FC 17, 125 + 121 registers", read_write((125, 121))),
    ("FC 14, 1 group of 121 registers", read_records((1, 121))),
    ("FC 14, 35 groups, 87 registers", read_records((35, 87))),
    ("FC 15, 1 group of 122 registers", write_records((1, 122))),
    ("FC 15, 27 groups, 31 registers", write_records((27, 31))),
)


def bus(lab):
    """Table `bus`: the grant question and the burst, in clocks; the same in both builds."""
    full, basic = (bus_rows(lab(0, 0, build), build) for build in ("full", "basic"))
    assert [row for row in full if row[0] in [name for name, *_ in basic]] == basic, f"{full} but {basic}"
    head = ["request", "grant asked to given", "given to `wb_cyc_o`", "beats", "`wb_cyc_o` high"]
    return {"bus": table([*head, "`write_stb_o`, from `wb_cyc_o`'s"], full)}


def bus_rows(device, build):
    """Its rows for one build."""
    rows = []
    device.setup(8)
    host_access(device, bus_address(Space.HOLDINGS, FIFO_COUNT), 31)
    device.run(1)
    for name, pdu in BUS_REQUESTS:
        if build == "basic" and name.split()[1].strip(",") not in BASIC:
            continue
        to_grant(device, pdu)
        asked = device.now
        log = device.run(9000, stop=mask("de"), log=mask("grant_req grant_ack wb_cyc wb_stb wb_ack write"))
        granted = log.rises("grant_ack")[0]
        up, down = log.rises("wb_cyc"), log.falls("wb_cyc")
        assert len(up) == 1, f"{name}: {len(up)} bursts"
        beats = len(log.rises("wb_ack"))
        write = log.rises("write")
        told = "–"
        if write:
            told = f"fall + {write[0] - down[0]}" if write[0] >= down[0] else f"rise + {write[0] - up[0]}"
        rows.append([name, granted - asked + 1, up[0] - granted, beats, number(down[0] - up[0]), told])
    return rows


def host(lab):
    """Table `host`: accesses of the host port and what they wait for."""
    device, rows = lab(), []
    device.setup(8)
    address = bus_address(Space.HOLDINGS, 5)
    nowhere = bus_address(Space.HOLDINGS, 125)
    first, _ = host_access(device, address, 0xCAFE, last=False)
    second, _ = host_access(device, address, last=False)
    third, got = host_access(device, address, last=True)
    assert got.host_dat == 0xCAFE
    device.run(1)
    missing, got = host_access(device, nowhere)
    assert got.host_err
    host_access(device, bus_address(Space.HOLDINGS, FIFO_COUNT), 31)
    device.run(1)
    rows += [
        ["first access of a `host_cyc_i`, memory free", first],
        ["each further access under the same `host_cyc_i`", f"{second}" if second == third else f"{second}, {third}"],
        ["an item that does not exist, to `host_err_o`", missing],
    ]
    for name, pdu in (
        ("a read of 1 register", frames.read(FC.READ_HOLDINGS, 0, 1)),
        ("a read of 125 registers", frames.read(FC.READ_HOLDINGS, 0, 125)),
        ("FC 18, 31 entries", frames.read_fifo(FIFO_COUNT)),
        ("a write of 123 registers", frames.write_registers(0, WORDS[:123])),
        ("FC 16", frames.mask_write(0, 1, 2)),
        ("FC 17, 125 + 121 registers", read_write((125, 121))),
        ("a write of 1968 coils", frames.write_coils(0, BITS[:1968])),
        ("a read of 2000 coils", frames.read(FC.READ_COILS, 0, 2000)),
        ("FC 14, 35 groups, 87 registers", read_records((35, 87))),
        ("FC 15, 1 group of 122 registers", write_records((1, 122))),
        ("FC 15, 27 groups, 31 registers", write_records((27, 31))),
    ):
        to_grant(device, pdu)
        device.run(6000, stop=mask("wb_cyc"))
        waits, _ = host_access(device, address)
        rows.append([f"an access that begins with the burst of {name}", number(waits)])
    # The other way round: the core waits for the host.
    for hold in (100, 1000):
        device.reset()
        device.host(1)
        to_wait = device.wave(frames.adu(OWN, frames.read(FC.READ_HOLDINGS, 0, 1)))
        device.run(to_wait[1] + 60 * device.bit_time, to_wait[0], mask("grant_req"))
        device.run(hold)
        device.host()
        log = device.run(1000, stop=mask("de"), log=mask("grant_ack"))
        given = log.rises("grant_ack")[0] - log.when[0]
        if hold == 100:
            kept = given
        assert given == kept
    rows.append(["`host_cyc_i` down to the grant, when the core waited for the host", kept])
    return {"host": table(["host port of `modbus_rtu_slave`", "clocks"], rows)}
