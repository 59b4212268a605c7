#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# fusesoc.sh - runs the FuseSoC targets of modbus_rtu_slave.core, as its users would.
# The user's own FuseSoC configuration stays out of it.
set -eu
cd "$(dirname -- "$0")/../.."
mkdir -p build
: > build/fusesoc.conf
for target in lint sim; do
  echo "=== fusesoc $target"
  .venv/bin/fusesoc --config build/fusesoc.conf --cores-root=. run --build-root build/fusesoc \
    --target="$target" modbus_rtu_slave
done
