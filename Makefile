# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# Variables reach the programs through the environment and are judged there: recipes only ever name
# them quoted, as "$$T".  So a bad value gives that program's own message and cannot break the shell.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
MAKEFLAGS += --no-print-directory

PY := .venv/bin/python
export PATH := $(CURDIR)/.venv/bin:$(PATH)
# Repeated Verilator builds cost 2 s instead of 12 with it.
ifneq ($(shell command -v ccache 2>/dev/null),)
export OBJCACHE ?= ccache
ifneq ($(shell test -w "$$HOME" && echo yes),yes)  # a container's nameless user
export CCACHE_DIR ?= $(CURDIR)/.venv/ccache
endif
endif

# --- what a target needs, installed on demand -----------------------------------------------------
# The recipes always run, look first, and leave a stamp that is right as it is; so nothing is rebuilt
# for nothing, and a removed package is noticed.
HASH := $(shell tools/bootstrap.sh hash)
stamp = .venv/$(1)-$(HASH).ok
APT_STAMP := $(call stamp,apt-demo)
VENV_STAMP := $(call stamp,demo)
.PHONY: FORCE
$(call stamp,apt-demo): FORCE
	@tools/bootstrap.sh apt demo
$(foreach set,demo web try test lint formal fpga ecp5 peers boards fusesoc map node,$(call stamp,$(set))): .venv/%-$(HASH).ok: FORCE
	@tools/bootstrap.sh venv $*

long_test := $(call stamp,try) $(call stamp,node)

# --- targets --------------------------------------------------------------------------------------
.PHONY: help demo serve try map quick test nightly lint formal synth peers bitstream waves mistakes fusesoc clean

##@ Use
-include sim/live.mk
## demo      bring the core up as a live serial device and play the specification's examples against it
## serve     the live device alone, until Ctrl-C: DEVICE= LINK= ADDRESS= BAUD= PARITY= STOP= INIT= MAP=tables or device.yaml WEB=8080 LOG=1
## try       docs/try.html: the core as WebAssembly behind the panel, one file for a browser

map: $(call stamp,map)  ## a device from one file, with all that belongs to it: FILE=device.yaml OUT=folder
	@[ -n "$${FILE-}" ] && [ -n "$${OUT-}" ] || { echo "map: FILE=device.yaml OUT=folder" >&2; exit 2; }
	@$(PY) tools/modbus map build "$$FILE" -o "$$OUT"

##@ Check
quick: $(call stamp,test) $(call stamp,lint)  ## under a minute, before a commit: lint of what differs, the model, a little of everything at the pins
	@$(PY) tools/quick.py

test: $(call stamp,test) $(if $(filter 1,$(FULL)),$(long_test))  ## the whole regression; T=name or T=file selects, FULL=1 runs the long version
	@$(PY) tools/run_tests.py $${T:+"$$T"}

nightly: $(call stamp,test) $(call stamp,lint) $(call stamp,formal) $(long_test)  ## everything, some hours; T=stage,... or NIGHTLY_SKIP=stage,...; report build/nightly.md
	@$(PY) tools/nightly.py $${T:+"$$T"}

lint: $(call stamp,lint)  ## every linter over every module and parameter set; T=module selects
	@$(PY) tools/lint.py $${T:+"$$T"}

formal: $(call stamp,formal)  ## proofs and covers; T=module, TIER=ci or nightly select, PLANTED=1: each must fail with a mistake in the RTL
	@$(PY) tools/formal.py $${TIER:+--tier="$$TIER"} $${PLANTED:+--planted} $${T:+"$$T"}

mistakes: $(call stamp,test)  ## plant deliberate mistakes in the RTL; the tests must catch each; T=part of a name; UPDATE=1 docs/mistakes.md
	@$(PY) tools/plant.py $${UPDATE:+--update} $${T:+"$$T"}

##@ Look
synth: $(call stamp,fpga) $(if $(FULL)$(UPDATE),$(call stamp,ecp5)) $(if $(UPDATE),$(call stamp,peers))  ## size and speed; PROFILE= BANK= DEVICE= select, QUICK=1 FULL=1 OPTIONS=1 CHECK=1 UPDATE=1: docs/size.md
	@$(PY) tools/synth.py $${QUICK:+--quick} $${FULL:+--full} $${OPTIONS:+--options} $${CHECK:+--check} \
	  $${UPDATE:+--update} $${PROFILE:+--profile="$$PROFILE"} $${BANK:+--bank="$$BANK"} $${DEVICE:+--device="$$DEVICE"}

auto_line: $(call stamp,test)  ## measure the automatic rate anew: table and plot of docs/auto_line.md; FULL=1 takes 10,000 starts
	@$(PY) tb/auto_line/update.py

peers: $(call stamp,fpga) $(call stamp,ecp5) $(call stamp,peers)  ## other open cores and our profiles, measured in one run; QUICK=1 one seed
	@$(PY) tools/synth.py --peers $${QUICK:+--quick} $${PROFILE:+--profile="$$PROFILE"} $${BANK:+--bank="$$BANK"}

bitstream: $(if $(BOARD),$(call stamp,boards))  ## a bitstream of the demonstration: BOARD=icebreaker hx8k ulx3s tangnano9k or all; UPDATE=1 the table
	@[ -n "$${BOARD-}" ] || { echo "bitstream: BOARD=icebreaker, hx8k, ulx3s, tangnano9k or all" >&2; exit 2; }
	@$(PY) tools/bitstream.py "$$BOARD" $${UPDATE:+--update}

waves: $(call stamp,test)  ## run the tests T=name with waveforms, open them in GTKWave where there is one
	@$(PY) tools/waves.py "$${T-}"

##@ Other
fusesoc: $(call stamp,fusesoc) $(call stamp,lint)  ## the FuseSoC targets: lint and sim run, the boards are set up
	@tools/fusesoc.sh

clean:  ## remove build products (.venv stays)
	@rm -rf build

help:  ## this list
	@awk '/^##@ /{printf "\n%s\n", substr($$0,5); next} \
	  /^## /{sub(/^## /,"  make "); print; next} \
	  /^[a-z]+:.*  ## /{split($$0,a,":"); sub(/.*  ## /,""); printf "  make %-9s %s\n", a[1], $$0}' Makefile
