// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_settings_value - the vector SETTINGS of the parameters of modbus_settings.vh, for settings_i.
//
// The bit time is CLK_HZ / BAUD, rounded to clocks, with BIT_FRACTIONS = 1 to sixteenths.  A rate that misses BAUD by
// more than 2 % stops elaboration: a receiver must accept that much (MODBUS over Serial Line V1.02, clause 3.2).

  // No term passes 32 bits: what CLK_HZ / BAUD leaves is below CLK_HZ / 8.
  localparam integer RATE         = (BAUD < 1) ? 1 : BAUD;       // nothing is divided by 0 before the check below
  localparam integer STEPS        = (BIT_FRACTIONS != 0) ? 16 : 1;
  localparam integer REST_STEPS   = ((CLK_HZ % RATE) * STEPS + RATE / 2) / RATE;          // 0..STEPS
  localparam integer BIT_TIME     = CLK_HZ / RATE + REST_STEPS / STEPS;
  localparam integer BIT_FRACTION = (BIT_FRACTIONS != 0) ? REST_STEPS % STEPS : 0;
  localparam integer MISSED       = (CLK_HZ % RATE) * STEPS - REST_STEPS * RATE;          // in steps of a clock
  localparam integer RATE_ERROR   = ((MISSED < 0) ? -MISSED : MISSED) / STEPS;

  localparam [`MB_SETTINGS_WIDTH-1:0] SETTINGS = {
    ASCII_EXTRA[1:0], ASCII_DATA_BITS == 8, ASCII != 0, BIT_FRACTION[3:0], DE_TAIL[3:0], DE_LEAD[3:0], STALL_LIMIT[15:0], RESPONSE_DELAY[11:0], DROP_LATE != 0, STRICT_TURNAROUND != 0,
    GAP_COUNT_ONLY != 0, BROADCAST != 0, FORMAT[1:0], BIT_TIME[15:0], ADDRESS[7:0]
  };

  generate
    if (ADDRESS < 0 || ADDRESS > 247) begin : gen_address
      ERROR_modbus_ADDRESS_from_0_to_247 illegal_parameter ();
    end
    if (BAUD < 1 || BIT_TIME < 8 || BIT_TIME > 65535) begin : gen_baud
      ERROR_modbus_BAUD_from_CLK_HZ_by_65535_to_CLK_HZ_by_8 illegal_parameter ();
    end
    if (RATE_ERROR > CLK_HZ / 50) begin : gen_rate
      ERROR_modbus_BAUD_is_missed_by_more_than_2_percent_with_a_whole_number_of_clocks_per_bit illegal_parameter ();
    end
    if (4 * GLITCH_FILTER > BIT_TIME) begin : gen_filter
      ERROR_modbus_GLITCH_FILTER_is_longer_than_a_quarter_of_a_bit illegal_parameter ();
    end
    if (FORMAT < 0 || FORMAT > 3) begin : gen_format
      ERROR_modbus_FORMAT_from_0_to_3 illegal_parameter ();
    end
    if (RESPONSE_DELAY < 0 || RESPONSE_DELAY > 4095 || STALL_LIMIT < 0 || STALL_LIMIT > 65535) begin : gen_delays
      ERROR_modbus_RESPONSE_DELAY_from_0_to_4095_and_STALL_LIMIT_from_0_to_65535 illegal_parameter ();
    end
    if (DE_LEAD < 0 || DE_LEAD > 15 || DE_TAIL < 0 || DE_TAIL > 15) begin : gen_driver
      ERROR_modbus_DE_LEAD_and_DE_TAIL_from_0_to_15 illegal_parameter ();
    end
    if (ASCII < 0 || ASCII > ASCII_MODE) begin : gen_ascii
      ERROR_modbus_ASCII_is_0_or_1_and_needs_ASCII_MODE_1 illegal_parameter ();
    end
    if (ASCII_DATA_BITS < 7 || ASCII_DATA_BITS > 8 || ASCII_EXTRA < 0 || ASCII_EXTRA > 3) begin : gen_ascii_characters
      ERROR_modbus_ASCII_DATA_BITS_is_7_or_8_and_ASCII_EXTRA_from_0_to_3 illegal_parameter ();
    end
    if ((BROADCAST | GAP_COUNT_ONLY | STRICT_TURNAROUND | DROP_LATE) >> 1 != 0) begin : gen_switches
      ERROR_modbus_BROADCAST_GAP_COUNT_ONLY_STRICT_TURNAROUND_DROP_LATE_are_0_or_1 illegal_parameter ();
    end
  endgenerate
