# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# vivado_stub.tcl - stands for Vivado while it runs a packaging script: prints what it was told, one Tcl list a line.
#
#   tclsh vivado_stub.tcl SCRIPT INFERS PARAMETERS PORTS [ARGUMENT]...
#
# INFERS is 1 if packaging shall find clock, reset and AXI by itself, as Vivado may, and 0 if not.  PARAMETERS and
# PORTS are what the module has: "module name name ..." lists in a list.  A command, an option or a property that
# does not stand here, a name that the module has not, a file that does not exist or a property of the wrong kind of
# object ends the script.  The commands are those of UG835 and UG1118, so far as the script needs them.

set argv_all $argv
lassign $argv script infers parameter_lists port_lists
set argv [lrange $argv_all 4 end]
set argc [llength $argv]
foreach entry $parameter_lists { set has_parameters([lindex $entry 0]) [lrange $entry 1 end] }
foreach entry $port_lists      { set has_ports([lindex $entry 0])      [lrange $entry 1 end] }

set top ""
set project 0
set core 0
array set there {}           ;# objects of the core, by handle

set properties(fileset) {include_dirs top}
set properties(file)    {file_type}
set properties(core)    {name version core_revision display_name description}
set properties(param)   {value_validation_type value_validation_range_minimum value_validation_range_maximum}
set properties(gui)     {display_name tooltip}
set properties(port)    {driver_value}
set properties(busif)   {slave_memory_map_ref}
set properties(busparam) {value}
set properties(block)   {range width}

proc say {args} { puts $args }

# Splits arguments: options of `flags` stand alone, those of `valued` take a value; returns the others.
proc arguments {name arguments flags valued} {
  upvar options options
  array unset options
  set rest {}
  while {[llength $arguments] > 0} {
    set arguments [lassign $arguments first]
    if {$first in $flags} { set options($first) 1
    } elseif {$first in $valued} {
      if {[llength $arguments] == 0} { error "$name: $first lacks its value" }
      set arguments [lassign $arguments options($first)]
    } elseif {[string match -* $first]} { error "$name: unknown option $first"
    } else { lappend rest $first }
  }
  return $rest
}

proc expect {name rest count} { if {[llength $rest] != $count} { error "$name: $count arguments expected: $rest" } }
proc in_project {name} { if {!$::project} { error "$name: no project is open" } }
proc of {name kind handle} { if {[lindex $handle 0] ne $kind} { error "$name: a $kind expected, not <$handle>" } }
proc find {handle} { return [expr {[info exists ::there($handle)] ? $handle : {}}] }

# ------------------------------------------------------------------ project

proc create_project {args} {
  expect create_project [arguments create_project $args {-force} {-part}] 2
  if {$::project} { error "create_project: a project is open" }
  set ::project 1
}
proc close_project {} { in_project close_project; set ::project 0; set ::core 0 }
proc add_files {args} {
  in_project add_files
  set rest [arguments add_files $args {-norecurse} {-fileset}]
  expect add_files $rest 1
  foreach file [lindex $rest 0] {
    if {![file isfile $file]} { error "add_files: no file $file" }
    set ::files($file) 1
    say add_files $file
  }
}
proc get_files {names} {
  foreach name $names { if {![info exists ::files($name)]} { error "get_files: $name is not in the project" } }
  return [list file {*}$names]
}
proc current_fileset {} { in_project current_fileset; return fileset }
proc update_compile_order {args} { expect update_compile_order [arguments update_compile_order $args {} {-fileset}] 0 }

proc set_property {name value object} {
  set kind [lindex $object 0]
  if {![info exists ::properties($kind)] || $name ni $::properties($kind)} { error "set_property: no $name of <$object>" }
  if {$kind eq "fileset" && $name eq "top"} { set ::top $value }
  say set_property $name $value {*}$object
}

# ------------------------------------------------------------------ packager

namespace eval ipx {
  proc package_project {args} {
    in_project ipx::package_project
    expect ipx::package_project [arguments ipx::package_project $args {-import_files -force} \
      {-root_dir -vendor -library -taxonomy}] 0
    foreach option {-root_dir -vendor -library -taxonomy} {
      if {![info exists options($option)]} { error "ipx::package_project: $option is missing" }
    }
    close [open [file join $options(-root_dir) component.xml] w]
    if {![info exists ::has_parameters($::top)]} { error "ipx::package_project: no module $::top" }
    set ::core 1
    array unset ::there
    foreach name $::has_parameters($::top) { set ::there([list param $name]) 1 }
    foreach name $::has_ports($::top) { set ::there([list port $name]) 1 }
    if {$::infers} {
      foreach name {clk_i rst_i} { set ::there([list busif $name]) 1 }
      if {[string match *axil_slave $::top]} {
        foreach kind {busif map} { set ::there([list $kind s_axil]) 1 }
        set ::there([list block s_axil reg0]) 1
      }
    }
    say package_project $::top
  }
  proc current_core {} {
    if {!$::core} { error "ipx::current_core: nothing is packaged" }
    return core
  }
  proc child {command kind arguments} {
    set rest [arguments $command $arguments {} {-of_objects}]
    expect $command $rest 1
    if {![info exists options(-of_objects)]} { error "$command: -of_objects is missing" }
    return [list [lindex $rest 0] $options(-of_objects)]
  }
  foreach {command kind} {get_user_parameters param get_ports port get_bus_interfaces busif get_memory_maps map} {
    proc $command {args} [string map [list COMMAND ipx::$command KIND $kind] {
      lassign [child COMMAND KIND $args] name parent
      of COMMAND core $parent
      return [find [list KIND $name]]
    }]
  }
  proc get_bus_parameters {args} {
    lassign [child ipx::get_bus_parameters busparam $args] name parent
    of ipx::get_bus_parameters busif $parent
    return [find [list busparam [lindex $parent 1] $name]]
  }
  proc get_address_blocks {args} {
    lassign [child ipx::get_address_blocks block $args] name parent
    of ipx::get_address_blocks map $parent
    return [array names ::there [list block [lindex $parent 1] $name]]
  }
  proc infer_bus_interface {port vlnv core} {
    of ipx::infer_bus_interface core $core
    if {[find [list port $port]] eq ""} { error "ipx::infer_bus_interface: no port $port" }
    if {$vlnv ni {xilinx.com:signal:clock_rtl:1.0 xilinx.com:signal:reset_rtl:1.0}} { error "infer: $vlnv" }
    set ::there([list busif $port]) 1
    say infer_bus_interface $port $vlnv
  }
  proc infer_bus_interfaces {vlnv core} {
    of ipx::infer_bus_interfaces core $core
    if {$vlnv ne "xilinx.com:interface:aximm_rtl:1.0"} { error "infer: $vlnv" }
    set ::there([list busif s_axil]) 1
    say infer_bus_interfaces $vlnv
  }
  proc add_bus_parameter {name busif} {
    of ipx::add_bus_parameter busif $busif
    set handle [list busparam [lindex $busif 1] $name]
    set ::there($handle) 1
    return $handle
  }
  proc associate_bus_interfaces {args} {
    set rest [arguments ipx::associate_bus_interfaces $args {} {-busif -clock -reset}]
    expect ipx::associate_bus_interfaces $rest 1
    of ipx::associate_bus_interfaces core [lindex $rest 0]
    foreach option [array names options] {
      if {[find [list busif $options($option)]] eq ""} { error "associate: no interface $options($option)" }
    }
    say associate_bus_interfaces $options(-busif) $options(-clock)
  }
  proc add_memory_map {name core} {
    of ipx::add_memory_map core $core
    set ::there([list map $name]) 1
    return [list map $name]
  }
  proc add_address_block {name map} {
    of ipx::add_address_block map $map
    set ::there([list block [lindex $map 1] $name]) 1
    return [list block [lindex $map 1] $name]
  }
  foreach command {create_xgui_files update_checksums check_integrity save_core} {
    proc $command {core} [string map [list COMMAND $command] { of ipx::COMMAND core $core; say COMMAND $::top }]
  }
}

namespace eval ipgui {
  proc get_guiparamspec {args} {
    expect ipgui::get_guiparamspec [arguments ipgui::get_guiparamspec $args {} {-name -component}] 0
    of ipgui::get_guiparamspec core $options(-component)
    if {[find [list param $options(-name)]] eq ""} { error "ipgui::get_guiparamspec: no parameter $options(-name)" }
    return [list gui $options(-name)]
  }
}

# Vivado finds `info script` in the script, as `source` sets it.
source $script
