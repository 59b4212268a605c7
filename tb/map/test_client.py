# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""NAME_client.py: clean under mypy --strict, and reads and writes what the model says, against the pymodbus server."""

import asyncio
import importlib.util
import subprocess
import sys
import threading

import pytest
from modbus_map.outputs import client
from pymodbus.client import AsyncModbusTcpClient, ModbusTcpClient

from map.output_devices import EVERYTHING, RELAY_BOX, SAMPLES
from map.served import Served


def module(place, device):
    """The client's module, imported."""
    ((path, text),) = client.generate(device).items()
    (place / path).write_text(text, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(path.removesuffix(".py"), place / path)
    made = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = made
    spec.loader.exec_module(made)
    return made


@pytest.fixture
def drive(tmp_path):
    """(module, served device) of the drive."""
    with Served(EVERYTHING) as served:
        yield module(tmp_path, EVERYTHING), served


def test_mypy_strict(tmp_path):
    """Modules and their users: attributes have their types, a wrong type is an error."""
    for device in (RELAY_BOX, EVERYTHING):
        module(tmp_path, device)
    (tmp_path / "user.py").write_text(
        "from pymodbus.client import AsyncModbusTcpClient, ModbusTcpClient\n"
        "from drive_client import Drive, DriveAsync, Mode\n"
        'd = Drive(ModbusTcpClient("h"))\n'
        "x: float = d.speed\n"
        "t: tuple[float, ...] = d.torques\n"
        "on: bool = d.status.on\n"
        "d.mode = Mode.ON_NOW\n"
        'd.write("ramp", 1.5)\n'
        's: str = d.read("tag")\n'
        "async def main() -> None:\n"
        '    a = DriveAsync(AsyncModbusTcpClient("h"))\n'
        "    y: float = await a.speed\n"
        '    await a.write("mode", Mode.OFF)\n'
        "    z: tuple[bool, ...] = (await a.read_all()).alarms\n",
        encoding="utf-8",
    )
    (tmp_path / "wrong.py").write_text(
        "from pymodbus.client import ModbusTcpClient\nfrom drive_client import Drive\n"
        'd = Drive(ModbusTcpClient("h"))\nd.tag = 5\nx: str = d.speed\nd.write("tag", 5)\n',
        encoding="utf-8",
    )
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "."]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    found = [line for line in done.stdout.splitlines() if "error:" in line]
    assert [line.split(":")[0] + ":" + line.split(":")[1] for line in found] == ["wrong.py:4", "wrong.py:5"], (
        done.stdout
    )


def test_values_are_those_of_the_model(drive):
    """Each sample in the server's registers, read by name, by attribute and by read_all."""
    made, served = drive
    device = made.Drive(served.client())
    for turn in range(5):
        wanted = {}
        for name, numbers in SAMPLES.items():
            point = EVERYTHING.point(name)
            raws = [point.raw(numbers[(turn + k) % len(numbers)]) for k in range(point.count)]
            served.put(point, raws)
            values = tuple(point.value(raw) for raw in raws)
            wanted[name] = values if point.is_array else values[0]
        everything = device.read_all()
        for name, value in wanted.items():
            if name == "status":
                value = (bool(value & 1), value >> 4 & 3)
            assert device.read(name) == value == getattr(everything, name) == getattr(device, name), name


def test_writing_gives_the_registers_of_the_model(drive):
    made, served = drive
    device = made.Drive(served.client())
    for name in ("mode", "ramp", "tag", "gains", "setpoint"):
        point = EVERYTHING.point(name)
        numbers = SAMPLES[name][-point.count :]
        raws = [point.raw(number) for number in numbers]
        values = tuple(point.value(raw) for raw in raws)
        setattr(device, name, values if point.is_array else values[0])
        assert served.get(point) == raws, name
    device.run = False
    device.alarms = [k % 3 == 0 for k in range(11)]
    device.curve = range(-50, 50)
    device.command = 0xBEEF
    assert served.get(EVERYTHING.point("alarms")) == [int(k % 3 == 0) for k in range(11)]
    assert device.curve == tuple(range(-50, 50))
    assert served.get(EVERYTHING.point("command")) == [0xBEEF]
    assert device.run is False and device.mode is made.Mode.V7TH


@pytest.mark.parametrize(
    "name, value",
    [("mode", 2), ("ramp", 60.001), ("ramp", -0.001), ("tag", "0123456789"), ("gains", (1, 2)), ("gains", (1, 2, 16384)),
     ("setpoint", 1e39)],
)  # fmt: skip
def test_what_the_slave_would_refuse_is_not_sent(drive, name, value):
    made, served = drive
    before = served.get(EVERYTHING.point(name))
    with pytest.raises(ValueError, match=name):
        made.Drive(served.client()).write(name, value)
    assert served.get(EVERYTHING.point(name)) == before


def test_rights_and_exceptions(drive):
    """Write only cannot be read, read only not written; an exception answer is an exception with its code."""
    made, served = drive
    device = made.Drive(served.client())
    with pytest.raises(AttributeError):
        _ = device.command
    with pytest.raises(AttributeError):
        device.speed = 1
    with pytest.raises(AttributeError, match="written"):
        device.write("speed", 1)
    point = made.Point("holding_registers", 300, "nowhere", "u16", 1, 1, "rw")
    for act in (lambda: device._read(point), lambda: device._write(point, 1)):
        with pytest.raises(made.ModbusError) as caught:
            act()
        assert caught.value.code == 2


def test_await(drive):
    made, served = drive

    async def play():
        client = AsyncModbusTcpClient("127.0.0.1", port=served.port)
        device = made.DriveAsync(client)
        assert await device.connect()
        await device.write("ramp", 12.345)
        assert await device.ramp == 12.345
        assert (await device.read_all()).ramp == 12.345
        assert await device.read("mode") == made.Mode.ON_NOW
        device.close()

    asyncio.run(play())


def test_neighbours_are_one_request(drive):
    """read_all sends one request for neighbours: count them."""
    made, served = drive
    device, asked = made.Drive(served.client()), []
    ask = device._ask
    device._ask = lambda table, at, quantity, what: (
        asked.append((table, at, quantity)) or ask(table, at, quantity, what)
    )
    device.read_all()
    assert asked == [
        ("coils", 0, 1), ("coils", 2, 11), ("discrete_inputs", 5, 3), ("input_registers", 0, 17),
        ("input_registers", 100, 5), ("holding_registers", 0, 11), ("holding_registers", 12, 2),
        ("holding_registers", 200, 100),
    ]  # fmt: skip


@pytest.mark.parametrize("width", [1, 2, 4])
def test_no_item_is_cut(tmp_path, width):
    """An array longer than a request: each request ends between two items, read or written, and all are moved."""
    made, count = module(tmp_path, RELAY_BOX), 300 // width
    point = made.Point("holding_registers", 0, "data", f"u{16 * width}", width, count, "rw", array=True)
    written = [(at, len(words)) for _, at, words in made._writes(point, list(range(300)))]
    for moved, most in ((made._chunks(point), 125), (written, 123)):
        assert [at for at, _ in moved] == [sum(size for _, size in moved[:n]) for n in range(len(moved))]
        assert sum(size for _, size in moved) == 300 and all(size % width == 0 and size <= most for _, size in moved)


def test_thread_is_gone():
    with Served(RELAY_BOX) as served:
        assert ModbusTcpClient("127.0.0.1", port=served.port).connect()
    assert not any(thread.name == "served" for thread in threading.enumerate())
