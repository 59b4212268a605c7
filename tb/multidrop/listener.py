# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""One slave of many as its model sees it: settings, and what its host must have seen so far."""

from harness import build
from protocol.defs import FIRST_ADDRESS, LAST_ADDRESS
from protocol.model import Slave

DEVICE = "slave_bench"
SEEN = ("drives", "frames", "errors", "writes")  # what the benches count for each node, in this order


class Listener:
    """Node `index` of a line, built with `parameters`.

    `wanted` are the times that it must have driven the line, its strobes of good frames, of any error, and its
    write pulses.
    """

    def __init__(self, index, parameters):
        self.index = index
        self.slave = Slave(build.model_config(DEVICE, parameters))
        self.touched, self.wanted = set(), dict.fromkeys(SEEN, 0)
        self.bit_time, self.de_lead, self.de_tail = 0, 0, 0

    @property
    def address(self):
        """The slave address."""
        return self.slave.config.address

    def hears(self, line):
        """The model's answer to `line`, None for silence."""
        answer = self.slave.request(line)
        self.wanted["frames"] += self.slave.good
        self.wanted["errors"] += bool(self.slave.errors)
        self.wanted["writes"] += len(self.slave.written)
        self.wanted["drives"] += answer is not None
        self.touched |= self.slave.touched
        return answer


def spread(rng, nodes):
    """Give `nodes` different addresses, the first and the last that there are among them."""
    between = rng.sample(range(FIRST_ADDRESS + 1, LAST_ADDRESS), len(nodes) - 2)
    addresses = [FIRST_ADDRESS, LAST_ADDRESS, *between]
    rng.shuffle(addresses)
    for node, address in zip(nodes, addresses):
        node.slave.config.address = address
