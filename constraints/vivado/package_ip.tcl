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

# Parameters: name, least, most (both empty: no range that a number can tell), meaning.
# docs/parameters.md is the long form; what depends on another parameter is judged at elaboration.
set parameters(modbus_rtu_slave) {
  CLK_HZ                1000 1000000000 "Frequency of clk_i in hertz"
  T15_MIN_US            0    100000     "Floor of t1.5 in microseconds, not above that of t3.5; 0: none"
  T35_MIN_US            0    100000     "Floor of t3.5 in microseconds; 0: none"
  FUNCTION_CODES        {}   {}         "Bit n: function code n is built in"
  USER_CODES            {}   {}         "Bit n: function code n is offered to the user port first"
  MAX_READ_BITS         1    2000       "Highest quantity of function codes 01 and 02"
  MAX_WRITE_BITS        1    1968       "Highest quantity of function code 0F"
  MAX_READ_REGISTERS    1    125        "Highest quantity of function codes 03 and 04"
  MAX_WRITE_REGISTERS   1    123        "Highest quantity of function code 10"
  RW_MAX_READ           1    125        "Highest read quantity of function code 17"
  RW_MAX_WRITE          1    121        "Highest write quantity of function code 17"
  COIL_BASE             0    65535      "Address of the first coil, zero-based"
  COIL_COUNT            0    65536      "Number of coils; 0: no such table"
  DISCRETE_BASE         0    65535      "Address of the first discrete input, zero-based"
  DISCRETE_COUNT        0    65536      "Number of discrete inputs; 0: no such table"
  INPUT_BASE            0    65535      "Address of the first input register, zero-based"
  INPUT_COUNT           0    65536      "Number of input registers; 0: no such table"
  HOLDING_BASE          0    65535      "Address of the first holding register, zero-based"
  HOLDING_COUNT         0    65536      "Number of holding registers; 0: no such table"
  READ_ONLY_BASE        0    65535      "First holding register that the line must not write"
  READ_ONLY_COUNT       0    65536      "How many holding registers the line must not write"
  FILE_COUNT            0    65535      "Files of function codes 14 and 15; 0: none"
  FILE_RECORDS          1    10000      "Records of each file, 16 bits a record"
  OVERLAY               0    1          "1: one block of holding registers, also seen as bits and input registers"
  SERVER_ID             {}   {}         "Function code 11: identifier, right-justified"
  SERVER_ID_BYTES       1    16         "How many bytes of SERVER_ID are sent"
  ADDITIONAL_DATA       {}   {}         "Function code 11: what follows the run indicator, right-justified"
  ADDITIONAL_DATA_BYTES 0    249        "How many bytes of ADDITIONAL_DATA are sent"
  VENDOR_NAME           {}   {}         "Function code 2B/0E: object 00"
  PRODUCT_CODE          {}   {}         "Function code 2B/0E: object 01"
  REVISION              {}   {}         "Function code 2B/0E: object 02"
  VENDOR_URL            {}   {}         "Function code 2B/0E: object 03, not there if empty"
  PRODUCT_NAME          {}   {}         "Function code 2B/0E: object 04, not there if empty"
  MODEL_NAME            {}   {}         "Function code 2B/0E: object 05, not there if empty"
  USER_APPLICATION_NAME {}   {}         "Function code 2B/0E: object 06, not there if empty"
  PRIVATE_OBJECTS       {}   {}         "Objects 80 to FF, right-justified: number, length and value of each"
  CONFORMITY            {}   {}         "Conformity level of 2B/0E: 01 02 03 81 82 83 (hexadecimal)"
  DEVICE_ID_LIMIT       {}   {}         "Largest PDU of an answer of 2B/0E, up to 253; only tests lower it"
  ALIVE_TIMEOUT_MS      0    16777215   "alive_o falls so many milliseconds after the last frame for us; 0: never"
}
set parameters(modbus_axil_slave) {
  HOLD                  0    1          "1: the word HOLD keeps the memory between accesses"
}

# What an input reads in a block design that leaves it open.  Clock, reset, receiver, address and bit time have none:
# they must be connected.
set idle(modbus_rtu_slave) {
  format_i 0 broadcast_en_i 1 gap_count_only_i 0 strict_turnaround_i 0 response_delay_i 0 stall_limit_i 0
  de_lead_i 0 de_tail_i 0 busy_i 0 failure_i 0 exception_status_i 0 run_indicator_i 1 diagnostic_i 0 write_lock_i 0
  host_cyc_i 0 host_stb_i 0 host_we_i 0 host_adr_i 0 host_dat_i 0
  user_adr_i 0 user_put_i 0 user_dat_i 0 user_done_i 0 user_pass_i 0 user_exception_i 0
  counter_stb_i 0 counter_adr_i 0
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
    if {[llength $parameter] == 0} { error "$top has no parameter $name" }
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
