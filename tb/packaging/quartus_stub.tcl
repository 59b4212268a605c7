# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# quartus_stub.tcl - stands for Quartus while it reads a .qip: prints "NAME VALUE" of each assignment.
#
#   tclsh quartus_stub.tcl FILE.qip
#
# The names are those that Quartus knows for files; any other ends the script, as does any other command.

set known {VERILOG_FILE VERILOG_INCLUDE_FILE SEARCH_PATH}

proc set_global_assignment {option name value} {
  if {$option ne "-name" || $name ni $::known} { error "set_global_assignment: $option $name" }
  puts [list $name [file normalize $value]]
}

set file [lindex $argv 0]
set quartus(qip_path) [file dirname [file normalize $file]]
source $file
