# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# The live device (make serve) and the demonstration (make demo). Included by the Makefile, which gives
# APT_STAMP (compilers are installed) and VENV_STAMP (.venv is there). Variables: sim/README.md.

LIVE_VARIABLES := DEVICE LINK PORT ADDRESS SLAVES BAUD PARITY STOP MODE DATA_BITS INIT MAP TRACE HOLD FAULT WEB TCP \
  RTU_TCP LOG SIGNALS SCRIPT PARAMETERS

# make ends with 0 on a signal only if it has become the device: see sim/exec_into.c. That needs `serve`
# to be the only goal, and no dry run. Where make cannot load the function, the shell's line below starts
# the device, and only the exit status after a signal differs.
ifeq ($(MAKECMDGOALS)$(findstring n,$(filter-out --%,$(firstword -$(MAKEFLAGS)))),serve)
-load build/exec_into.so
build/exec_into.so: sim/exec_into.c | $(APT_STAMP)
	@mkdir -p build
	@$(CC) -O2 -shared -fPIC -o $@ $< || true
endif

live_quote = '$(subst ','\'',$(1))'
# Names given on the command line: one that is nearly one of ours is refused.
live_given = $(foreach v,$(.VARIABLES),$(if $(filter command line,$(origin $(v))),$(v)))

.PHONY: serve demo try

serve: $(APT_STAMP) $(if $(WEB),$(call stamp,web))
	$(exec_into python3,sim/serve.py,DEVICE=$(DEVICE),LINK=$(LINK),PORT=$(PORT),ADDRESS=$(ADDRESS),SLAVES=$(SLAVES),\
	  BAUD=$(BAUD),PARITY=$(PARITY),STOP=$(STOP),MODE=$(MODE),DATA_BITS=$(DATA_BITS),INIT=$(INIT),MAP=$(MAP),\
	  TRACE=$(TRACE),HOLD=$(HOLD),FAULT=$(FAULT),WEB=$(WEB),TCP=$(TCP),RTU_TCP=$(RTU_TCP),LOG=$(LOG),\
	  SIGNALS=$(SIGNALS),SCRIPT=$(SCRIPT),PARAMETERS=$(PARAMETERS),GIVEN=$(live_given))
	@mkdir -p build; exec python3 sim/serve.py DIE_WITH_PARENT=yes GIVEN='$(live_given)' \
	  $(foreach v,$(LIVE_VARIABLES),$(call live_quote,$(v)=$($(v))))

demo: $(APT_STAMP) $(VENV_STAMP)
	@mkdir -p build
	@exec .venv/bin/python sim/demo.py

try: $(call stamp,try)
	@$(PY) tools/try_page.py
