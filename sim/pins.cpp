// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// pins - a model behind the pins that the bridge knows.

#include "pins.h"

#include "model.h"

namespace {

struct Top {
  Vmodel top;
  ~Top() { top.final(); }
};

class Device : Top, public Pins {
 public:
  Device() : Pins(top) {}
  void cycle() override { ::cycle(top); }
};

}  // namespace

std::unique_ptr<Pins> new_device() { return std::make_unique<Device>(); }
