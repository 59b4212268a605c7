// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// pins - what the bridge sees of a compiled model: the ports of modbus_live_ports.vh that it uses.
//
// The bridge knows no model, so it is compiled once; pins.cpp is compiled with every model.

#pragma once

#include <cstdint>
#include <memory>

// (type, port) each, by width: Verilator has 8, 16 or 32 bits for a port
#define PINS_OF_A_DEVICE(_)                                                                           \
  _(uint8_t, rst_i) _(uint8_t, rxd_i) _(uint8_t, txd_o) _(uint8_t, de_o)                              \
  _(uint8_t, address_i) _(uint16_t, bit_time_i) _(uint8_t, format_i) _(uint8_t, ascii_i)              \
  _(uint8_t, eight_bits_i) _(uint8_t, busy_i) _(uint8_t, failure_i) _(uint8_t, exception_status_i)    \
  _(uint8_t, run_indicator_i) _(uint16_t, diagnostic_i) _(uint8_t, write_lock_i)                      \
  _(uint8_t, host_cyc_i) _(uint8_t, host_stb_i) _(uint8_t, host_we_i) _(uint32_t, host_adr_i)         \
  _(uint16_t, host_dat_i) _(uint16_t, host_dat_o) _(uint8_t, host_ack_o) _(uint8_t, host_err_o)       \
  _(uint8_t, events_o) _(uint8_t, write_stb_o) _(uint8_t, write_space_o) _(uint16_t, write_first_o)   \
  _(uint16_t, write_last_o) _(uint16_t, write_file_o) _(uint8_t, listen_only_o) _(uint8_t, rx_active_o) \
  _(uint8_t, idle_o)

struct Pins {
#define PIN(type, name) type &name;
  PINS_OF_A_DEVICE(PIN)
#undef PIN

  virtual ~Pins() = default;
  // One clock cycle; the outputs are then those behind the edge.
  virtual void cycle() = 0;

 protected:
#define PIN(type, name) name(top.name),
  template <class Top>
  explicit Pins(Top &top) : PINS_OF_A_DEVICE(PIN) made_(true) {}
#undef PIN

 private:
  bool made_;  // ends the list above
};

std::unique_ptr<Pins> new_device();
