# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# Makes the Vivado project of the Arty A7 and, if asked, its bitstream.
#
#   vivado -mode batch -source constraints/arty_a7/create_project.tcl -tclargs [PART] [build]
#
# PART: xc7a35ticsg324-1L (default) or xc7a100tcsg324-1.  The project goes to build/arty_a7.

set here [file dirname [file normalize [info script]]]
set root [file normalize $here/../..]
set part xc7a35ticsg324-1L
set build 0
foreach word $argv {
  if {$word eq "build"} { set build 1 } else { set part $word }
}

create_project -force modbus_arty_a7 $root/build/arty_a7 -part $part

# rtl/modbus.f names the files of the core
set handle [open $root/rtl/modbus.f]
foreach line [split [read $handle] "\n"] {
  set line [string trim [lindex [split [regsub {//.*} $line {}] "#"] 0]]
  if {$line ne "" && ![string match "+*" $line]} { add_files -norecurse $root/$line }
}
close $handle
add_files -norecurse [glob $root/rtl/include/*.vh $root/rtl/engine/*.vh]
add_files -norecurse $root/constraints/common/modbus_board.v
add_files -norecurse $here/arty_a7_top.v
set_property include_dirs [list $root/rtl/include $root/rtl/engine] [current_fileset]
set_property top arty_a7_top [current_fileset]

add_files -fileset constrs_1 -norecurse $here/arty_a7.xdc
add_files -fileset constrs_1 -norecurse $root/constraints/sync/modbus_sync.xdc
set_property SCOPED_TO_REF modbus_sync [get_files modbus_sync.xdc]

if {$build} {
  launch_runs impl_1 -to_step write_bitstream -jobs 2
  wait_on_run impl_1
  if {[get_property PROGRESS [get_runs impl_1]] ne "100%"} { error "implementation failed" }
  if {[get_property STATS.WNS [get_runs impl_1]] < 0} { error "timing is missed" }
}
