# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# quartus_stub.tcl - stands for Quartus while it reads a .qip or the settings of a board: prints each assignment, a Tcl
# list a line.
#
#   tclsh quartus_stub.tcl FILE
#
# NAME VALUE of a global assignment, files and paths made absolute; PIN NAME of a location.  The names are those that
# Quartus knows; any other ends the script, as does any other command.

set files {VERILOG_FILE VERILOG_INCLUDE_FILE SEARCH_PATH}
set settings {FAMILY DEVICE TOP_LEVEL_ENTITY VERILOG_INPUT_VERSION INTERNAL_FLASH_UPDATE_MODE}

proc set_global_assignment {option name value} {
  if {$option ne "-name"} { error "set_global_assignment: $option" }
  if {$name in $::files} {
    puts [list $name [file normalize $value]]
  } elseif {$name in $::settings} {
    puts [list $name $value]
  } else {
    error "set_global_assignment: $name"
  }
}

proc set_location_assignment {pin option name} {
  if {$option ne "-to" || ![string match PIN_* $pin]} { error "set_location_assignment: $pin $option" }
  puts [list $pin $name]
}

proc set_instance_assignment {option name value to port} {
  if {$option ne "-name" || $to ne "-to" || $name ni {IO_STANDARD WEAK_PULL_UP_RESISTOR}} {
    error "set_instance_assignment: $option $name $to"
  }
}

set file [lindex $argv 0]
set quartus(qip_path) [file dirname [file normalize $file]]
source $file
