# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# de10_lite_pins.tcl - settings and pins of the DE10-Lite for a project that brings its own list of files, as that of
# FuseSoC does.
#
# They stand in ../de10_lite/de10_lite.qsf, a project of its own; this runs it without the files it adds, for their
# paths are relative to that project.  A bracket in a .qsf is part of a name, not a command.

proc modbus_pins {qsf} {
  set channel [open $qsf]
  foreach line [split [read $channel] "\n"] {
    if {![regexp {^\s*set_global_assignment\s+-name\s+(\w+_FILE|SEARCH_PATH|PROJECT_OUTPUT_DIRECTORY)\s} $line]} {
      uplevel #0 [string map {[ \\[ ] \\]} $line]
    }
  }
  close $channel
}

modbus_pins [file join [file dirname [file normalize [info script]]] .. de10_lite de10_lite.qsf]
