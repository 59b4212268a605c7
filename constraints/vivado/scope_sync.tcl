# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# scope_sync.tcl - reads ../sync/modbus_sync.xdc for every instance of modbus_sync: FuseSoC cannot say that of an .xdc.

read_xdc -ref modbus_sync [file join [file dirname [file normalize [info script]]] .. sync modbus_sync.xdc]
