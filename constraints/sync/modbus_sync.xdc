# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# Vivado constraints of the synchroniser, for every instance of modbus_sync:
#
#   read_xdc -ref modbus_sync modbus_sync.xdc
#
# or, in a project, add the file and set its property SCOPED_TO_REF to modbus_sync.

# Both flip-flops beside each other (the RTL says so too; here for a netlist that lost it)
set_property ASYNC_REG TRUE [get_cells {meta_q_reg sync_q_reg}]

# The pin may change at any time: the way to the first flip-flop has no timing.
set_false_path -to [get_pins meta_q_reg/D]
