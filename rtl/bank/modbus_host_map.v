// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_host_map - one map for a host: the tables of modbus_bank_ram, and as space 5 the core with counters and settings.
//
// A Wishbone B4 classic slave in front of the host port of modbus_bank_ram.  Every space but 5 goes to the bank unchanged.
// Items of space 5 (hexadecimal):
//
// | Item    | Holds                                                       | Write |
// |---------|-------------------------------------------------------------|-------|
// | 00      | diagnostic register                                         | err   |
// | 01      | bit 0: listen-only mode                                     | err   |
// | 02      | entries of the event log, 0..64                             | err   |
// | 0A..12  | event counter (0A), counters by sub-function of 08H         | err   |
// | 20..27  | with LINE_HEALTH = 1: the words of modbus_line_health       | clears all |
// | 40..7F  | event log, 40 the newest                                    | err   |
// | 80      | address                                                     | yes   |
// | 81      | bit time in clocks                                          | yes   |
// | 82      | 1..0 format, MB_FORMAT_*; with ASCII_MODE = 1: 2 ASCII mode, 3 eight bits in it, 5..4 MB_SET_ASCII_EXTRA | yes |
// | 83      | options: 0 broadcast, 1 gap count only, 2 strict, 3 drop late | yes |
// | 84      | response delay in bit times                                 | yes   |
// | 85      | stall limit in bit times                                    | yes   |
// | 86      | 3..0 driver lead, 7..4 driver tail in bit times             | yes   |
// | 87      | 3..0 sixteenths of a clock per bit beyond item 81         | yes   |
// | 88      | 0 busy, 1 run indicator, 5..2 failure code                  | yes   |
// | 89      | exception status, function code 07H                         | yes   |
// | 8A      | 15..1: these bits of the diagnostic register are set        | yes   |
// | 8B      | 0: write lock                                               | yes   |
// | 8C      | 0: the line is idle, settings may change                    | err   |
//
// Other items answer err, and so does 87 with BIT_FRACTIONS = 0.  Unused bits read 0 and are ignored when written.
// A write of 81 leaves 87 as it is: a new rate needs both.
//
// With HOST_SETTINGS = 1 items 80 to 8B are registers that begin with the INITIAL_* parameters, after configuration and
// after rst_i; settings_i, host_state_i and write_lock_i are ignored.  With 0 these inputs go to the outputs, the items read
// them, and a write answers err: inputs that are constants cost nothing.
// The core takes a setting at once: write rate and format while item 8C is 1.
//
// Items of 80 and above answer in the clock of the strobe, those below when the status port or modbus_line_health does.
// An access to space 5 keeps host_cyc_i at the bank, so it may stand in a block that is one piece for the line.
// HOST_MAP = 0 leaves the map out: the bank answers err to space 5, and no cell is used.

`default_nettype none
`include "modbus_defs.vh"

module modbus_host_map #(
  parameter integer HOST_MAP      = 1,           // 0: no space 5
  parameter integer HOST_SETTINGS = 1,           // 0: the host reads the settings, but cannot change them
  parameter integer BIT_FRACTIONS = 0,           // that of the core
  parameter integer ASCII_MODE    = 0,           // that of the core
  parameter integer LINE_HEALTH   = 0,           // 1: there is a modbus_line_health
  parameter [`MB_SETTINGS_WIDTH-1:0]   INITIAL_SETTINGS = 0,
  parameter [`MB_HOST_STATE_WIDTH-1:0] INITIAL_STATE    = 0,
  parameter [0:0]                      INITIAL_LOCK     = 0
) (
  input  wire        clk_i,
  input  wire        rst_i,

  // Host: Wishbone B4 classic slave
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [18:0] host_adr_i,                 // {space, item}
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o,

  // Bank: to the host port of modbus_bank_ram; *_o of here are *_i of there
  output wire        bank_cyc_o,
  output wire        bank_stb_o,
  output wire        bank_we_o,
  output wire [18:0] bank_adr_o,
  output wire [15:0] bank_dat_o,
  input  wire [15:0] bank_dat_i,
  input  wire        bank_ack_i,
  input  wire        bank_err_i,

  // Core: status port
  output wire        status_stb_o,               // level until status_ack_i
  output wire [6:0]  status_adr_o,
  input  wire [15:0] status_dat_i,
  input  wire        status_ack_i,

  // Read port of modbus_line_health; the inputs count with LINE_HEALTH = 1
  output wire        health_stb_o,               // level until health_ack_i
  output wire [2:0]  health_adr_o,
  input  wire [15:0] health_dat_i,
  input  wire        health_ack_i,
  output wire        health_clear_o,             // strobe: all words to 0

  // Core: settings and state of the host; the inputs count with HOST_SETTINGS = 0
  input  wire [`MB_SETTINGS_WIDTH-1:0]   settings_i,
  input  wire [`MB_HOST_STATE_WIDTH-1:0] host_state_i,
  input  wire                            write_lock_i,
  input  wire                            idle_i,           // level : nothing is received, worked on or sent
  output wire [`MB_SETTINGS_WIDTH-1:0]   settings_o,
  output wire [`MB_HOST_STATE_WIDTH-1:0] host_state_o,
  output wire                            write_lock_o
);

  // Items, all in hexadecimal
  localparam [3:0] ITEM_ADDRESS = 4'h0, ITEM_BIT_TIME = 4'h1, ITEM_FORMAT = 4'h2, ITEM_OPTIONS = 4'h3, ITEM_DELAY = 4'h4,
                   ITEM_STALL = 4'h5, ITEM_DRIVER = 4'h6, ITEM_FRACTION = 4'h7, ITEM_STATE = 4'h8,
                   ITEM_EXCEPTION_STATUS = 4'h9, ITEM_DIAGNOSTIC = 4'hA, ITEM_LOCK = 4'hB, ITEM_IDLE = 4'hC;

  // Fields that share an item
  localparam integer OPTIONS = `MB_SET_BROADCAST;          // four bits from here on
  localparam integer STATE_BITS = 6;                       // busy, run and failure, from bit 0 of the state on

  wire        own  = (HOST_MAP != 0) & (host_adr_i[18:16] == `MB_SPACE_CORE);
  wire [3:0]  item = host_adr_i[3:0];
  wire        near = own & (host_adr_i[15:8] == 8'd0);
  wire        health   = near & (host_adr_i[7:3] == 5'b00100) & (LINE_HEALTH != 0);
  wire        status   = near & ~host_adr_i[7] & ~health;
  wire        settings = near & (host_adr_i[7:4] == 4'h8);

  // ------------------------------------------------------------------ which items exist

  wire [6:0] number = host_adr_i[6:0];
  wire       status_exists   = number[6] | (number <= 7'h02) | (number >= 7'h0A & number <= 7'h12);
  wire       settings_exist  = (item <= ITEM_IDLE) & ((BIT_FRACTIONS != 0) | (item != ITEM_FRACTION));
  wire       settings_writes = (HOST_SETTINGS != 0) & settings_exist & (item != ITEM_IDLE);

  wire stb        = host_cyc_i & host_stb_i;
  wire own_ack    = (status & status_exists & ~host_we_i & status_ack_i) | (health & (host_we_i | health_ack_i)) |
                    (settings & (host_we_i ? settings_writes : settings_exist));
  wire own_err    = ~health & (host_we_i ? ~(settings & settings_writes)
                                         : ~((status & status_exists) | (settings & settings_exist)));

  // ------------------------------------------------------------------ registers

  wire [`MB_SETTINGS_WIDTH-1:0]   set;
  wire [`MB_HOST_STATE_WIDTH-1:0] state;
  wire                            lock;

  generate
    if (HOST_MAP != 0 && HOST_SETTINGS != 0) begin : gen_registers
      reg [`MB_SETTINGS_WIDTH-1:0]   set_q   = INITIAL_SETTINGS;
      reg [`MB_HOST_STATE_WIDTH-1:0] state_q = INITIAL_STATE;
      reg                            lock_q  = INITIAL_LOCK;
      wire                           write   = stb & host_we_i & settings;
      wire                           unused  = &{1'b0, settings_i, host_state_i, write_lock_i};

      always @(posedge clk_i) begin
        if (rst_i) begin
          set_q   <= INITIAL_SETTINGS;
          state_q <= INITIAL_STATE;
          lock_q  <= INITIAL_LOCK;
        end else if (write) begin
          case (item)
            ITEM_ADDRESS:          set_q[`MB_SET_ADDRESS]             <= host_dat_i[7:0];
            ITEM_BIT_TIME:         set_q[`MB_SET_BIT_TIME]            <= host_dat_i;
            ITEM_FORMAT: begin
              set_q[`MB_SET_FORMAT] <= host_dat_i[1:0];
              if (ASCII_MODE != 0) {set_q[`MB_SET_ASCII_EXTRA], set_q[`MB_SET_EIGHT_BITS], set_q[`MB_SET_ASCII]} <= host_dat_i[5:2];
            end
            ITEM_OPTIONS:          set_q[OPTIONS +: 4]                <= host_dat_i[3:0];
            ITEM_DELAY:            set_q[`MB_SET_RESPONSE_DELAY]      <= host_dat_i[11:0];
            ITEM_STALL:            set_q[`MB_SET_STALL_LIMIT]         <= host_dat_i;
            ITEM_DRIVER:           {set_q[`MB_SET_DE_TAIL], set_q[`MB_SET_DE_LEAD]} <= host_dat_i[7:0];
            ITEM_FRACTION: if (BIT_FRACTIONS != 0) set_q[`MB_SET_BIT_FRACTION] <= host_dat_i[3:0];
            ITEM_STATE:            state_q[STATE_BITS-1:0]            <= host_dat_i[STATE_BITS-1:0];
            ITEM_EXCEPTION_STATUS: state_q[`MB_HOST_EXCEPTION_STATUS] <= host_dat_i[7:0];
            ITEM_DIAGNOSTIC:       state_q[`MB_HOST_DIAGNOSTIC]       <= host_dat_i[15:1];
            ITEM_LOCK:             lock_q                             <= host_dat_i[0];
            default: ;
          endcase
        end
      end

      assign set   = set_q;
      assign state = state_q;
      assign lock  = lock_q;
    end else begin : gen_inputs
      wire unused = &{1'b0, clk_i, rst_i};
      assign set   = settings_i;
      assign state = host_state_i;
      assign lock  = write_lock_i;
    end
  endgenerate

  // ------------------------------------------------------------------ reading

  // {further periods, eight bits, ASCII mode}
  wire [3:0] ascii = (ASCII_MODE != 0) ? {set[`MB_SET_ASCII_EXTRA], set[`MB_SET_EIGHT_BITS], set[`MB_SET_ASCII]} : 4'd0;
  reg [15:0] setting;

  always @* begin
    case (item)
      ITEM_ADDRESS:          setting = {8'd0, set[`MB_SET_ADDRESS]};
      ITEM_BIT_TIME:         setting = set[`MB_SET_BIT_TIME];
      ITEM_FORMAT:           setting = {10'd0, ascii, set[`MB_SET_FORMAT]};
      ITEM_OPTIONS:          setting = {12'd0, set[OPTIONS +: 4]};
      ITEM_DELAY:            setting = {4'd0, set[`MB_SET_RESPONSE_DELAY]};
      ITEM_STALL:            setting = set[`MB_SET_STALL_LIMIT];
      ITEM_DRIVER:           setting = {8'd0, set[`MB_SET_DE_TAIL], set[`MB_SET_DE_LEAD]};
      ITEM_FRACTION:         setting = {12'd0, set[`MB_SET_BIT_FRACTION]};
      ITEM_STATE:            setting = {10'd0, state[STATE_BITS-1:0]};
      ITEM_EXCEPTION_STATUS: setting = {8'd0, state[`MB_HOST_EXCEPTION_STATUS]};
      ITEM_DIAGNOSTIC:       setting = {state[`MB_HOST_DIAGNOSTIC], 1'b0};
      ITEM_LOCK:             setting = {15'd0, lock};
      default:               setting = {15'd0, idle_i};
    endcase
  end

  assign host_dat_o = ~own ? bank_dat_i : host_adr_i[7] ? setting : health ? health_dat_i : status_dat_i;
  assign host_ack_o = own ? stb & own_ack : bank_ack_i;
  assign host_err_o = own ? stb & own_err : bank_err_i;

  assign bank_cyc_o = host_cyc_i;
  assign bank_stb_o = host_stb_i & ~own;
  assign bank_we_o  = host_we_i;
  assign bank_adr_o = host_adr_i;
  assign bank_dat_o = host_dat_i;

  assign status_stb_o = stb & status & status_exists & ~host_we_i;
  assign status_adr_o = number;

  assign health_stb_o   = stb & health & ~host_we_i;
  assign health_adr_o   = host_adr_i[2:0];
  assign health_clear_o = stb & health & host_we_i;

  assign settings_o   = set;
  assign host_state_o = state;
  assign write_lock_o = lock;

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);

  // The host keeps to the rules, the bank answers what it is asked, the status port only what stands there.
  wishbone_rules #(.MASTER(1)) u_host_rules (
    .clk_i(clk_i), .rst_i(rst_i), .cyc(host_cyc_i), .stb(host_stb_i), .we(host_we_i), .adr(host_adr_i),
    .dat(host_dat_i), .ack(host_ack_o), .err(host_err_o)
  );
  wishbone_rules #(.MASTER(2), .SLAVE(1)) u_bank_rules (
    .clk_i(clk_i), .rst_i(rst_i), .cyc(bank_cyc_o), .stb(bank_stb_o), .we(bank_we_o), .adr(bank_adr_o),
    .dat(bank_dat_o), .ack(bank_ack_i), .err(bank_err_i)
  );
  always @* if (!status_stb_o) assume (!status_ack_i);
  always @* if (!health_stb_o) assume (!health_ack_i);

  always @* begin
    // One side at a time, and none without the host.
    assert (3'd0 + bank_stb_o + status_stb_o + health_stb_o + health_clear_o <= 3'd1);
    if (bank_stb_o || status_stb_o || health_stb_o || health_clear_o) assert (host_stb_i);
    if (status_stb_o) assert (host_cyc_i && !host_we_i && host_adr_i[18:7] == {`MB_SPACE_CORE, 9'd0});
    if (HOST_MAP == 0) assert (bank_stb_o == host_stb_i && host_ack_o == bank_ack_i && host_err_o == bank_err_i);
    // The words are read by a read, and cleared by a write alone, at once.
    if (health_stb_o || health_clear_o)
      assert (LINE_HEALTH != 0 && host_cyc_i && host_adr_i[18:3] == {`MB_SPACE_CORE, 13'd4} && health_adr_o == host_adr_i[2:0]);
    if (health_stb_o) assert (!host_we_i && host_ack_o == health_ack_i);
    if (health_clear_o) assert (host_we_i && host_ack_o);
    // Nothing else hangs: outside the bank, the status port and the words the answer is there at once.
    if (host_cyc_i && host_stb_i && !bank_stb_o && !status_stb_o && !health_stb_o) assert (host_ack_o || host_err_o);
    if (host_ack_o && host_we_i && own && !health_clear_o) assert (HOST_SETTINGS != 0 && host_adr_i[15:4] == 12'h008);
  end
  always @(posedge clk_i) if (f_past) begin
    // Settings change only by an acknowledged write to space 5.
    if (!$past(rst_i) && !$past(host_ack_o && host_we_i && own && !health_clear_o) && HOST_SETTINGS != 0 && HOST_MAP != 0)
      assert ($stable(settings_o) && $stable(host_state_o) && $stable(write_lock_o));
    if (!rst_i && !$past(rst_i) && HOST_SETTINGS == 0)
      assert (settings_o == settings_i && host_state_o == host_state_i && write_lock_o == write_lock_i);
    cover (host_ack_o && status_stb_o);
    cover (host_ack_o && host_we_i && own && !health_clear_o);
    if (LINE_HEALTH != 0) begin
      cover (host_ack_o && health_stb_o);
      cover (host_ack_o && health_clear_o);
    end
  end
`endif

endmodule

`default_nettype wire
