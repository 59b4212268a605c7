# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# package_ip.tcl - packages the core as IP for Vivado's block designs and IP catalog.
#
#   vivado -mode batch -source constraints/vivado/package_ip.tcl [-tclargs [OUT] [TOP]...]
#
# OUT is the IP repository to fill (build/vivado/ip as it comes, from the root of the checkout), TOP what to package:
#
#   modbus_rtu_slave     the drop-in with register RAM
#   modbus_axil_slave    AXI4-Lite in front of its host port: connect the ports of the same names
#
# both as it comes.  Then add OUT to the repositories of your project: Settings > IP > Repository.
# OUT/TOP is written anew each time, with copies of the sources; the script stops if it is something else than a
# packaged IP.  The project that Vivado needs for it is build/vivado/package_TOP.

set root [file normalize [file join [file dirname [info script]] .. ..]]
set out [file join $root build vivado ip]
set tops {modbus_rtu_slave modbus_axil_slave}
if {[llength $argv] > 0} { set out [file normalize [lindex $argv 0]] }
if {[llength $argv] > 1} { set tops [lrange $argv 1 end] }

set vendor modbus_rtu_slave
set title(modbus_rtu_slave) "Modbus RTU slave"
set text(modbus_rtu_slave) "Modbus RTU slave: coils, inputs, registers and files in block RAM, Wishbone port for the host"
set title(modbus_axil_slave) "AXI4-Lite port of the Modbus RTU slave"
set text(modbus_axil_slave) "AXI4-Lite in front of the host port of the Modbus RTU slave"

# Parameters: name, least, most (both empty: no range that two numbers can tell), meaning.  Those of the drop-in are the
# tables of docs/parameters.md; rules over two parameters are checked at elaboration.
proc modbus_documented {root} {
  set channel [open [file join $root docs parameters.md]]
  fconfigure $channel -encoding utf-8
  set lines [split [read $channel] "\n"]
  close $channel
  set found {}
  foreach line $lines {
    if {![regexp {^\| `([A-Z][A-Z0-9_]*)` \|([^|]*)\|([^|]*)\|([^|]*)\|} $line -> name default range meaning]} continue
    set range [string trim $range]
    if {[string match MB_* $name]} continue
    set least {}
    set most {}
    if {$range eq "0, 1"} { set least 0; set most 1 }
    regexp {^(\d+) \.\. (\d+)(,|$)} $range -> least most
    lappend found $name $least $most [string map {` {}} [string trim $meaning]]
  }
  return $found
}
set parameters(modbus_rtu_slave) [modbus_documented $root]
set parameters(modbus_axil_slave) {
  HOLD                  0    1          "1: the word HOLD keeps the memory between accesses"
}

# What an input reads in a block design that leaves it open.  Clock, reset and receiver have no such value: they must be
# connected.
set idle(modbus_rtu_slave) {
  host_cyc_i 0 host_stb_i 0 host_we_i 0 host_adr_i 0 host_dat_i 0
}
set idle(modbus_axil_slave) {}

# The Verilog files that rtl/modbus.f lists, and the include files beside them.
proc modbus_sources {root} {
  set channel [open [file join $root rtl modbus.f]]
  set files {}
  foreach line [split [read $channel] "\n"] {
    set line [string trim $line]
    if {[string match "*.v" $line]} { lappend files [file join $root $line] }
  }
  close $channel
  return $files
}

proc modbus_headers {root} {
  return [lsort [glob -directory [file join $root rtl] include/*.vh engine/*.vh]]
}

proc modbus_version {root} {
  set channel [open [file join $root VERSION]]
  set version [string trim [read $channel]]
  close $channel
  return [split $version .]
}

# The interface of a single signal, inferred unless the packager has done it by itself.
proc modbus_signal {core port kind} {
  if {[llength [ipx::get_bus_interfaces $port -of_objects $core]] == 0} {
    ipx::infer_bus_interface $port xilinx.com:signal:${kind}_rtl:1.0 $core
  }
  return [ipx::get_bus_interfaces $port -of_objects $core]
}

proc modbus_bus_parameter {interface name value} {
  if {[llength [ipx::get_bus_parameters $name -of_objects $interface]] == 0} {
    ipx::add_bus_parameter $name $interface
  }
  set_property value $value [ipx::get_bus_parameters $name -of_objects $interface]
}

proc modbus_package {root out vendor top title text parameters idle} {
  set place [file join $out $top]
  # Only what looks like our own work is written over: OUT/TOP might be somebody's checkout.
  if {[file exists $place] && ![file exists [file join $place component.xml]]} {
    error "$place is there and is no packaged IP: not written over"
  }
  file delete -force $place
  file mkdir $place

  create_project -force package_$top [file join $root build vivado package_$top]
  add_files -norecurse [concat [modbus_sources $root] [modbus_headers $root]]
  set_property file_type "Verilog Header" [get_files [modbus_headers $root]]
  set_property include_dirs [list [file join $root rtl include] [file join $root rtl engine]] [current_fileset]
  set_property top $top [current_fileset]
  update_compile_order -fileset sources_1

  lassign [modbus_version $root] major minor patch
  ipx::package_project -root_dir $place -vendor $vendor -library ip -taxonomy /UserIP -import_files -force
  set core [ipx::current_core]
  set_property name $top $core
  set_property version $major.$minor $core
  set_property core_revision $patch $core
  set_property display_name $title $core
  set_property description $text $core

  foreach {name least most meaning} $parameters {
    set parameter [ipx::get_user_parameters $name -of_objects $core]
    if {[llength $parameter] == 0} continue          ;# of another top
    if {$least ne ""} {
      set_property value_validation_type range_long $parameter
      set_property value_validation_range_minimum $least $parameter
      set_property value_validation_range_maximum $most $parameter
    }
    set shown [ipgui::get_guiparamspec -name $name -component $core]
    set_property display_name $name $shown
    set_property tooltip $meaning $shown
  }

  foreach {name value} $idle {
    set port [ipx::get_ports $name -of_objects $core]
    if {[llength $port] == 0} { error "$top has no port $name" }
    set_property driver_value $value $port
  }

  # Clock and reset.  The reset is active high, which Vivado would not guess from its name.
  set clock [modbus_signal $core clk_i clock]
  set reset [modbus_signal $core rst_i reset]
  modbus_bus_parameter $reset POLARITY ACTIVE_HIGH
  modbus_bus_parameter $clock ASSOCIATED_RESET rst_i

  # AXI4-Lite: 2 MB of addresses, see docs/buses.md
  if {$top eq "modbus_axil_slave"} {
    if {[llength [ipx::get_bus_interfaces s_axil -of_objects $core]] == 0} {
      ipx::infer_bus_interfaces xilinx.com:interface:aximm_rtl:1.0 $core
    }
    ipx::associate_bus_interfaces -busif s_axil -clock clk_i $core
    if {[llength [ipx::get_memory_maps s_axil -of_objects $core]] == 0} {
      ipx::add_memory_map s_axil $core
    }
    set map [ipx::get_memory_maps s_axil -of_objects $core]
    set_property slave_memory_map_ref s_axil [ipx::get_bus_interfaces s_axil -of_objects $core]
    if {[llength [ipx::get_address_blocks * -of_objects $map]] == 0} {
      ipx::add_address_block tables $map
    }
    set block [lindex [ipx::get_address_blocks * -of_objects $map] 0]
    set_property range 2097152 $block
    set_property width 32 $block
  }

  ipx::create_xgui_files $core
  ipx::update_checksums $core
  ipx::check_integrity $core
  ipx::save_core $core
  close_project
  puts "packaged $top in $place"
}

foreach top $tops {
  if {![info exists parameters($top)]} { error "cannot package $top: choose from [lsort [array names parameters]]" }
  modbus_package $root $out $vendor $top $title($top) $text($top) $parameters($top) $idle($top)
}
