# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# Quartus constraints of the synchroniser, for every instance of modbus_sync in the design:
#
#   set_global_assignment -name SDC_FILE modbus_sync.sdc
#
# The pin may change at any time: the way to the first flip-flop has no timing.
# Quartus Pro leaves the entity out of register names: there take the instance, which is u_sync in the core, as in
# {*u_sync|meta_q}.
set_false_path -to [get_registers {*modbus_sync:*|meta_q}]
