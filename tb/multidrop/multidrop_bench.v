// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// multidrop_bench - NODES slaves and a master on one two-wire line, the driver enables resolved.
//
// A transceiver drives the line while its enable is 1 and lets go of it otherwise; the bias of the line makes it 1
// while nobody drives.  All receivers stay enabled, so each slave hears its own answer too.  The bench counts the
// clocks with more than one driver and those with an undefined level, and for each node the strobes that its host sees.
//
// For the line driver of the tests the bench looks like one device: `rxd_i` is the level that the master drives while
// `master_de_i` is 1, `txd_o` and `de_o` are the slaves together.  The host and counter ports are those of the node
// that `node_i` selects.

`default_nettype none

module multidrop_bench #(
  parameter integer NODES           = 32,
  parameter integer T15_MIN_US      = 0,
  parameter integer T35_MIN_US      = 0,
  parameter integer TABLE_COUNT     = 8,        // size of each of the four tables
  parameter integer DIAGNOSED_EVERY = 4,        // nodes 0, 4, 8, .. have the codes of DIAGNOSED_CODES
  parameter [63:0]  PLAIN_CODES     = 64'd0,    // the others have these
  parameter [63:0]  DIAGNOSED_CODES = 64'd0
) (
  input  wire                  clk_i,
  input  wire                  rst_i,

  // Line
  input  wire                  rxd_i,           // what the master drives
  input  wire                  master_de_i,
  output wire                  txd_o,           // what the slaves drive together, 1 at rest
  output wire                  de_o,            // some slave drives
  output wire                  line_o,

  // Configuration; a field a node
  input  wire [8*NODES-1:0]    address_i,
  input  wire [16*NODES-1:0]   bit_time_i,
  input  wire [4*NODES-1:0]    de_lead_i,
  input  wire [4*NODES-1:0]    de_tail_i,
  input  wire [1:0]            format_i,

  // What happened since clear_i; a field a node
  input  wire                  clear_i,
  output wire [8*NODES-1:0]    drives_o,        // times that it began to drive the line
  output wire [8*NODES-1:0]    frames_o,        // strobes of frame_stb_o
  output wire [8*NODES-1:0]    errors_o,        // clocks with any error strobe
  output wire [8*NODES-1:0]    writes_o,        // strobes of write_stb_o
  output reg  [31:0]           collisions_o,    // clocks with more than one driver
  output reg  [31:0]           undefined_o,     // clocks with a level that is neither 0 nor 1

  // The node that is looked at
  input  wire [7:0]            node_i,
  input  wire                  host_cyc_i,
  input  wire                  host_stb_i,
  input  wire                  host_we_i,
  input  wire [18:0]           host_adr_i,
  input  wire [15:0]           host_dat_i,
  output wire [15:0]           host_dat_o,
  output wire                  host_ack_o,
  output wire                  host_err_o,
  input  wire                  status_stb_i,
  input  wire [6:0]            status_adr_i,
  output wire [15:0]           status_dat_o,
  output wire                  status_ack_o,
  output wire                  listen_only_o,
  output wire [6:0]            log_count_o
);

  // ------------------------------------------------------------------ the line

  wire [NODES-1:0] txd, de;
  tri1             line;

  assign line   = master_de_i ? rxd_i : 1'bz;
  assign line_o = line;
  assign txd_o  = &(txd | ~de);
  assign de_o   = |de;

  reg [7:0] drivers;
  integer   each;

  always @* begin
    drivers = {7'd0, master_de_i};
    for (each = 0; each < NODES; each = each + 1) drivers = drivers + {7'd0, de[each]};
  end

  always @(posedge clk_i) begin
    if (clear_i) begin
      collisions_o <= 32'd0;
      undefined_o  <= 32'd0;
    end else begin
      if (drivers > 8'd1) collisions_o <= collisions_o + 32'd1;
      if (line !== 1'b0 && line !== 1'b1) undefined_o <= undefined_o + 32'd1;
    end
  end

  // ------------------------------------------------------------------ the nodes

  wire [16*NODES-1:0] host_dat, status_dat;
  wire [NODES-1:0]    host_ack, host_err, status_ack, listen_only;

  assign host_dat_o            = host_dat[16*node_i +: 16];
  assign host_ack_o            = host_ack[node_i];
  assign host_err_o            = host_err[node_i];
  assign status_dat_o         = status_dat[16*node_i +: 16];
  assign status_ack_o         = status_ack[node_i];
  assign listen_only_o         = listen_only[node_i];

  genvar n;
  generate
    for (n = 0; n < NODES; n = n + 1) begin : gen_node
      wire       here = node_i == n;
      wire       frame_stb, write_stb;
      wire [6:0] errors;
      reg        de_q;
      reg  [7:0] drives_q, frames_q, errors_q, writes_q;

      assign line                = de[n] ? txd[n] : 1'bz;
      assign drives_o[8*n +: 8]  = drives_q;
      assign frames_o[8*n +: 8]  = frames_q;
      assign errors_o[8*n +: 8]  = errors_q;
      assign writes_o[8*n +: 8]  = writes_q;

      always @(posedge clk_i) begin
        if (clear_i) begin
          drives_q <= 8'd0;
          frames_q <= 8'd0;
          errors_q <= 8'd0;
          writes_q <= 8'd0;
        end else begin
          if (de[n] && !de_q) drives_q <= drives_q + 8'd1;
          if (frame_stb)      frames_q <= frames_q + 8'd1;
          if (|errors)        errors_q <= errors_q + 8'd1;
          if (write_stb)      writes_q <= writes_q + 8'd1;
        end
        de_q <= de[n];
      end

      slave_bench #(
        .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .COIL_COUNT(TABLE_COUNT), .DISCRETE_COUNT(TABLE_COUNT),
        .INPUT_COUNT(TABLE_COUNT), .HOLDING_COUNT(TABLE_COUNT),
        .FUNCTION_CODES(n % DIAGNOSED_EVERY == 0 ? DIAGNOSED_CODES : PLAIN_CODES)
      ) u_slave (
        .clk_i(clk_i), .rst_i(rst_i), .rxd_i(line), .txd_o(txd[n]), .de_o(de[n]), .address_i(address_i[8*n +: 8]),
        .bit_time_i(bit_time_i[16*n +: 16]), .format_i(format_i), .broadcast_en_i(1'b1), .gap_count_only_i(1'b0),
        .strict_turnaround_i(1'b0), .drop_late_i(1'b0), .response_delay_i(12'd0), .stall_limit_i(16'd0), .de_lead_i(de_lead_i[4*n +: 4]),
        .de_tail_i(de_tail_i[4*n +: 4]), .bit_fraction_i(4'd0), .ascii_i(1'b0), .eight_bits_i(1'b0), .ascii_extra_i(2'd0), .busy_i(1'b0), .failure_i(4'd0), .exception_status_i(8'd0),
        .run_indicator_i(1'b1), .diagnostic_i(16'd0), .write_lock_i(1'b0), .host_cyc_i(host_cyc_i && here),
        .host_stb_i(host_stb_i && here), .host_we_i(host_we_i), .host_adr_i(host_adr_i), .host_dat_i(host_dat_i),
        .host_dat_o(host_dat[16*n +: 16]), .host_ack_o(host_ack[n]), .host_err_o(host_err[n]), .user_req_o(),
        .user_count_o(), .user_adr_i(8'd0), .user_dat_o(), .user_put_i(1'b0), .user_dat_i(8'd0), .user_done_i(1'b0),
        .user_pass_i(1'b0), .user_exception_i(4'd0), .listen_only_o(listen_only[n]), 
        .status_stb_i(status_stb_i && here), .status_adr_i(status_adr_i), .status_dat_o(status_dat[16*n +: 16]),
        .status_ack_o(status_ack[n]), .write_stb_o(write_stb), .write_space_o(), .write_first_o(), .write_last_o(),
        .write_file_o(), .alive_o(), .idle_o(), .rx_active_o(), .frame_stb_o(frame_stb), .err_parity_o(errors[0]),
        .err_framing_o(errors[1]), .err_overrun_o(errors[2]), .err_crc_o(errors[3]), .err_short_o(errors[4]),
        .err_long_o(errors[5]), .err_gap_o(errors[6])
      );
    end
  endgenerate

endmodule

`default_nettype wire
