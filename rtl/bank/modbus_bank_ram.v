// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_bank_ram - the four tables and the files in block RAM, with a second Wishbone side for the host.
//
// Registers and file records share a memory; bits have one of their own unless they fit beside the registers.  Each memory
// has one port, and line and host take turns.  A side that has the memory keeps it while its cyc is high, so a burst of
// the line is one snapshot for the host, and an access of the host is one for the line.
// A burst takes two clocks a beat.  The longest, 2000 coils one by one, makes the host wait 4001 clocks.  With
// BITS_PER_BEAT = 16 the bits lie sixteen to a word and a beat moves a word: then it waits 253 clocks.  The host may
// hold host_cyc_i over several accesses to read or write a block in one piece.  Meanwhile the core waits, up to its
// stall limit; only a range that does not exist is refused at once.  Each such question costs the host one clock.
//
// Host side: Wishbone B4 classic, address {space, item} as on the line, no byte selects.  ack comes two clocks after stb
// when the memory is free, err for an address outside the tables.  The host may write every table.  Record r of file f is
// item (f - 1) * FILE_RECORDS + r of space 4.  The host must hold address, direction and data from stb to ack or err, as
// Wishbone demands: the item read is that of the clock before ack.
//
// OVERLAY = 1: one block of HOLDING_COUNT registers (MODBUS Application Protocol V1.1b3, clause 4.3, device
// with one block).  Coil and discrete input n are bit n mod 16 of register n / 16, input registers are the
// holding registers.  Contents are 0 after configuration and survive rst_i.

`default_nettype none
`include "modbus_defs.vh"

module modbus_bank_ram #(
  parameter integer BITS_PER_BEAT = 1,           // 1 or 16, that of the core
  parameter integer CHECK_WRITES = 0,            // 1: the core has checking passes; every value is acceptable here
`include "modbus_tables.vh"
) (
  input  wire        clk_i,
  input  wire        rst_i,
  input  wire        write_lock_i,

  // Core: grant and Wishbone
`include "modbus_bank_ports.vh"
  ,

  // Host: Wishbone
  input  wire        host_cyc_i,
  input  wire        host_stb_i,
  input  wire        host_we_i,
  input  wire [18:0] host_adr_i,                 // {space, item}
  input  wire [15:0] host_dat_i,
  output wire [15:0] host_dat_o,
  output wire        host_ack_o,
  output wire        host_err_o                  // address outside the tables
);

  // ------------------------------------------------------------------ whose turn it is

  reg host_q = 1'b0;                 // the memory is the host's
  reg lent_q = 1'b0;                 // for this clock the host has lent the comparison to the grant question
  reg ready_q = 1'b0;                // the output of the memory belongs to the address now shown

  wire        stb  = host_q ? host_cyc_i & host_stb_i : wb_stb_i & wb_cyc_i;
  // Where cyc is already high the core shows the address of a beat a clock before its strobe.
  wire        show = host_q ? host_cyc_i & host_stb_i : wb_cyc_i;
  wire        we   = host_q ? host_we_i  : wb_we_i;
  wire [2:0]  space = host_q ? host_adr_i[18:16] : wb_adr_i[18:16];
  wire [15:0] item  = host_q ? host_adr_i[15:0]  : wb_adr_i[15:0];
  wire        ack   = stb & ready_q;
  wire        bits  = (space[2:1] == 2'b00);
  wire        refused;               // the address of the host is outside the tables
  wire        checks = (CHECK_WRITES != 0) & (space[2:1] == 2'b11);    // a checking pass: nothing is stored
  wire        write = ack & we & ~(host_q & refused) & ~checks;
  wire [15:0] read;                  // to the core
  wire [15:0] single;                // to the host, which has one bit at a time in any case

  // Between two accesses of the host one clock of the guard is enough for a question of the core.  The core has no
  // grant, so the memory stays untouched in that clock and the block of the host stays one piece.
  wire        lend = host_q & grant_req_i & (ack | ~host_stb_i);

  always @(posedge clk_i) begin
    host_q  <= host_cyc_i & (host_q | ~wb_cyc_i) & ~lend & ~rst_i;
    lent_q  <= host_cyc_i & lend;
    ready_q <= show & ~ack & ~rst_i;
  end

  assign wb_ack_o   = ack & ~host_q;
  assign wb_err_o   = 1'b0;
  assign wb_dat_o   = read;
  assign host_ack_o = ack & host_q & ~refused;
  assign host_err_o = ack & host_q & refused;
  assign host_dat_o = single;

  // The guard judges the question of the core, or with the memory in the hands of the host the item that the host shows.
  modbus_bank_guard #(
`include "modbus_tables_inst.vh"
  ) u_guard (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(write_lock_i), .req_i(grant_req_i),
    .space_i(host_q ? space : grant_space_i), .first_i(host_q ? item : grant_first_i),
    .last_i(host_q ? item : grant_last_i), .write_i(grant_write_i & ~host_q), .file_i(grant_file_i), .flat_i(host_q),
    .other_i(host_q), .wait_i(lent_q), .ack_o(grant_ack_o), .refused_o(refused), .exception_o(exception_o)
  );

  // ------------------------------------------------------------------ where an item is

  // Holding registers, input registers, file records; then coils and discrete inputs, a word each, where that takes no
  // more blocks of 256 words than a memory of their own.  With sixteen bits a beat the word of item n is n / 16,
  // counted from that of the first item.  It lies beside the registers if all fit one block, since a beat writes back
  // what it has read, and that path must be short.  In the overlay the bits are those of the registers.
  localparam REGISTERS = (OVERLAY != 0) ? HOLDING_COUNT : HOLDING_COUNT + INPUT_COUNT;
  localparam FILES_END = REGISTERS + FILE_COUNT * FILE_RECORDS;
  localparam WIDE      = (BITS_PER_BEAT != 1);
  localparam PACKED    = WIDE || OVERLAY != 0;                 // sixteen bits to a word
  localparam integer COIL_WORDS     = (COIL_COUNT + COIL_BASE % 16 + 15) / 16,
                     DISCRETE_WORDS = (DISCRETE_COUNT + DISCRETE_BASE % 16 + 15) / 16;
  localparam BITS      = (OVERLAY != 0) ? 0 : WIDE ? COIL_WORDS + DISCRETE_WORDS : COIL_COUNT + DISCRETE_COUNT;
  localparam BESIDE    = WIDE ? FILES_END + BITS <= 256 :
                         (FILES_END + BITS + 255) / 256 <= (FILES_END + 255) / 256 + (BITS + 4095) / 4096;
  localparam ITEMS     = (BESIDE != 0) ? FILES_END + BITS : FILES_END;
  localparam WORDS     = (ITEMS > 0) ? ITEMS : 1;              // a word that is never written: nothing remains of it
  localparam W         = (WORDS > 1) ? $clog2(WORDS) : 1;

  localparam integer COIL_SHIFT     = FILES_END - (WIDE ? COIL_BASE / 16 : COIL_BASE),
                     DISCRETE_SHIFT = FILES_END + (WIDE ? COIL_WORDS - DISCRETE_BASE / 16 : COIL_COUNT - DISCRETE_BASE),
                     HOLDING_SHIFT = -HOLDING_BASE,             INPUT_SHIFT    = HOLDING_COUNT - INPUT_BASE;

  // Files begin at 1.  In the arithmetic of as many bits as the memory has the product is a shift where FILE_RECORDS
  // is a power of two.
  // The widths are those of the largest memory:
  // verilator lint_off UNUSED
  wire [17:0]  file    = {2'd0, grant_file_i} - 18'd1;
  wire [17:0]  place   = (PACKED && bits) ? {6'd0, item[15:4]} : {2'd0, item};
  // verilator lint_on UNUSED
  reg  [W-1:0] file_shift_q;         // the file is known long before its burst
  reg  [W-1:0] shift;

  always @(posedge clk_i) file_shift_q <= REGISTERS[W-1:0] + file[W-1:0] * FILE_RECORDS[W-1:0];

  always @* begin
    case (space)
      `MB_SPACE_COILS:     shift = COIL_SHIFT[W-1:0];
      `MB_SPACE_DISCRETES: shift = DISCRETE_SHIFT[W-1:0];
      `MB_SPACE_INPUTS:    shift = INPUT_SHIFT[W-1:0];
      `MB_SPACE_HOLDINGS:  shift = HOLDING_SHIFT[W-1:0];
      default:             shift = REGISTERS[W-1:0];
    endcase
    if (OVERLAY != 0 && !space[2]) shift = {W{1'b0}};
    if (FILE_COUNT != 0 && space[2] && !host_q) shift = file_shift_q;
  end

  // ------------------------------------------------------------------ the memories

  wire [15:0]  given = host_q ? host_dat_i : wb_dat_i;
  wire         apart = bits & (BITS != 0) & (BESIDE == 0);      // in the memory of bits
  wire [W-1:0] at    = place[W-1:0] + shift;
  wire [15:0]  data;

  (* no_rw_check *) reg [15:0] words [0:WORDS-1];
  reg [15:0] word_q;
  integer    i;

  initial for (i = 0; i < WORDS; i = i + 1) words[i] = 16'd0;

  always @(posedge clk_i) begin
    if (write && !apart && ITEMS != 0) words[at] <= data;
    word_q <= words[at];
  end

`ifdef FORMAL
  reg f_past = 1'b0;
  always @(posedge clk_i) f_past <= 1'b1;
  always @* if (!f_past) assume (rst_i);
`endif

  // With sixteen bits to a word a beat writes back what it has read, but for its own bits.
  generate
    if (WIDE) begin : gen_wide
      wire        one = host_q & bits;
      wire [15:0] lanes;
      wire [15:0] stood;                       // what stands in the word of bits
      assign single = bits ? {15'd0, stood[item[3:0]]} : word_q;
      wire [15:0] merged = ((one ? {16{given[0]}} : given) & lanes) | (stood & ~lanes);
      modbus_bank_lanes u_lanes (.first_i(item), .last_i(host_q ? item : grant_last_i), .lanes_o(lanes));
      if (BESIDE != 0 || OVERLAY != 0) begin : gen_in_words
        assign stood  = word_q;
        assign data   = bits ? merged : given;
        assign read   = word_q;
      end else begin : gen_in_words_of_their_own
        localparam BW = (BITS > 1) ? $clog2(BITS) : 1;
        localparam integer COIL_PLACE = -(COIL_BASE / 16), DISCRETE_PLACE = COIL_WORDS - DISCRETE_BASE / 16;
        (* no_rw_check *) reg [15:0] memory [0:BITS-1];
        reg  [15:0]   bits_q;
        wire [BW-1:0] at_bits = place[BW-1:0] + (space[0] ? DISCRETE_PLACE[BW-1:0] : COIL_PLACE[BW-1:0]);
        integer       k;

        initial for (k = 0; k < BITS; k = k + 1) memory[k] = 16'd0;

        always @(posedge clk_i) begin
          if (write && bits) memory[at_bits] <= merged;
          bits_q <= memory[at_bits];
        end

        assign stood  = bits_q;
        assign data   = given;
        assign read   = bits ? stood : word_q;

`ifdef FORMAL
        // Words of coils are at the front of the memory of bits, those of discrete inputs behind them.
        always @* if ((wb_ack_o || host_ack_o) && bits)
          assert (at_bits == (space[0] ? COIL_WORDS + item / 16 - DISCRETE_BASE / 16 : item / 16 - COIL_BASE / 16));
        always @(posedge clk_i) if (f_past && ack && bits && !$past(rst_i))
          assert (at_bits == $past(at_bits) && !$past(write && bits));
`endif
      end
    end else if (OVERLAY != 0) begin : gen_overlay
      wire [15:0] mask = bits ? 16'd1 << item[3:0] : 16'hFFFF;
      assign data = ((bits ? {16{given[0]}} : given) & mask) | (word_q & ~mask);
      assign read = bits ? {15'd0, word_q[item[3:0]]} : word_q;
      assign single = read;
    end else if (BESIDE != 0) begin : gen_beside
      assign data = {given[15:1] & {15{~bits}}, given[0]};
      assign read = word_q;
      assign single = read;
    end else begin : gen_apart
      localparam BW = $clog2(BITS);
      localparam integer COIL_PLACE = -COIL_BASE, DISCRETE_PLACE = COIL_COUNT - DISCRETE_BASE;
      (* no_rw_check *) reg memory [0:BITS-1];
      reg           bit_q, bits_q;       // bits_q: it is one that was read
      wire [BW-1:0] at_bit = place[BW-1:0] + (space[0] ? DISCRETE_PLACE[BW-1:0] : COIL_PLACE[BW-1:0]);
      integer       k;

      initial for (k = 0; k < BITS; k = k + 1) memory[k] = 1'b0;

      always @(posedge clk_i) begin
        if (write && bits) memory[at_bit] <= given[0];
        bit_q  <= memory[at_bit];
        bits_q <= bits;
      end

      assign data = given;
      assign read = bits_q ? {15'd0, bit_q} : word_q;
      assign single = read;

`ifdef FORMAL
      // Coils are at the front of the memory of bits, discrete inputs behind them.
      always @* if ((wb_ack_o || host_ack_o) && bits)
        assert (at_bit == (space[0] ? COIL_COUNT + item - DISCRETE_BASE : item - COIL_BASE));
`endif
    end
  endgenerate

`ifdef FORMAL
  // The host keeps to the rules of its bus; of the line only what stands below is assumed.
  wishbone_rules u_line_rules (
    .clk_i(clk_i), .rst_i(rst_i), .cyc(wb_cyc_i), .stb(wb_stb_i), .we(wb_we_i), .adr(wb_adr_i), .dat(wb_dat_i),
    .ack(wb_ack_o), .err(wb_err_o)
  );
  wishbone_rules #(.MASTER(1), .WITHDRAWS(1)) u_host_rules (
    .clk_i(clk_i), .rst_i(rst_i), .cyc(host_cyc_i), .stb(host_stb_i), .we(host_we_i), .adr(host_adr_i),
    .dat(host_dat_i), .ack(host_ack_o), .err(host_err_o)
  );

  // Each side has had a beat since its cyc rose.
  wire f_host_beat = host_ack_o | host_err_o;
  reg  f_line_q = 1'b0, f_host_q = 1'b0;
  always @(posedge clk_i) begin
    f_line_q <= ~rst_i & wb_cyc_i & (f_line_q | wb_ack_o);
    f_host_q <= ~rst_i & host_cyc_i & (f_host_q | f_host_beat);
  end

  // The last range that was granted; the beats of the core lie in it.
  reg         f_granted_q = 1'b0, f_write_q = 1'b0;
  reg  [2:0]  f_space_q;
  reg  [15:0] f_first_q, f_last_q, f_file_q;
  always @(posedge clk_i) begin
    if (grant_ack_o) begin
      f_granted_q <= (exception_o == 4'd0);
      f_write_q   <= grant_write_i;
      f_space_q   <= grant_space_i;
      f_first_q   <= grant_first_i;
      f_last_q    <= grant_last_i;
      f_file_q    <= grant_file_i;
    end
    if (rst_i || (grant_req_i && !grant_ack_o)) f_granted_q <= 1'b0;
  end
  always @* begin
    // A cycle begins only under a grant; a question within a cycle comes behind its first burst.
    if (wb_cyc_i && !f_line_q) assume (f_granted_q && !grant_req_i);
    assume (grant_first_i <= grant_last_i);
    if (grant_space_i != `MB_SPACE_COILS && grant_space_i != `MB_SPACE_HOLDINGS && grant_space_i != `MB_SPACE_FILES)
      assume (!grant_write_i);
    if (wb_cyc_i && wb_stb_i) begin
      assume (f_granted_q && !grant_req_i && grant_file_i == f_file_q);
      assume (wb_adr_i[18:16] == f_space_q ||
              (CHECK_WRITES != 0 && wb_we_i && f_space_q != `MB_SPACE_FILES && wb_adr_i[18:16] == `MB_CHECK_OF(f_space_q)));
      assume (wb_adr_i[15:0] >= f_first_q && wb_adr_i[15:0] <= f_last_q && (!wb_we_i || f_write_q));
    end
  end
  always @(posedge clk_i) if (f_past) begin
    // A question stands still; the file number is there well before its burst.
    if ($past(grant_req_i && !grant_ack_o) && grant_req_i)
      assume ($stable(grant_space_i) && $stable(grant_first_i) && $stable(grant_last_i) && $stable(grant_write_i) &&
              $stable(grant_file_i));
    if (wb_cyc_i && wb_stb_i) assume ($stable(grant_file_i));
    // Within a cycle the address is there a clock before a strobe that does not follow an acknowledge.
    if ($past(wb_cyc_i && !wb_ack_o) && wb_cyc_i && wb_stb_i) assume ($stable(wb_adr_i));
  end

  always @* if (f_past) begin
    // The sides never share a beat, and neither breaks into a block of the other.
    assert (!(wb_ack_o && f_host_beat));
    assert (!(f_line_q && wb_cyc_i && f_host_beat));
    assert (!(f_host_q && host_cyc_i && wb_ack_o));
    assert (!(f_line_q && f_host_q && wb_cyc_i && host_cyc_i));
    assert (!(f_line_q && wb_cyc_i && host_q));
    if (f_host_q && host_cyc_i) assert (host_q || lent_q);
    if (lent_q) assert (!host_q);
    // A write is a beat of one side, of the line only where it was granted.
    if (write) assert ((wb_ack_o && wb_we_i && f_granted_q && f_write_q) || (host_ack_o && host_we_i));
    if (host_err_o) assert (!write);
    if (wb_ack_o && wb_we_i && wb_adr_i[18:17] == 2'b11) assert (!write);
  end

  // Where it goes: each table and each file has its part of the memories.  Registers are at the front.
  wire [17:0] f_item = {2'd0, item};
  wire [31:0] f_at   = (space == `MB_SPACE_HOLDINGS || OVERLAY != 0) ? ((OVERLAY != 0 && bits) ? item / 16 : item - HOLDING_BASE)
                     : (space == `MB_SPACE_INPUTS) ? HOLDING_COUNT + item - INPUT_BASE
                     : (space == `MB_SPACE_COILS) ? FILES_END + (WIDE ? item / 16 - COIL_BASE / 16 : item - COIL_BASE)
                     : WIDE ? FILES_END + COIL_WORDS + item / 16 - DISCRETE_BASE / 16
                     : FILES_END + COIL_COUNT + item - DISCRETE_BASE;
  wire [31:0] f_record = REGISTERS + (host_q ? f_item : (f_file_q - 1) * FILE_RECORDS + item);
  always @* if (f_past && ((wb_ack_o && !checks) || host_ack_o)) begin
    if (space == `MB_SPACE_FILES) assert (at == f_record && f_record < FILES_END);
    else if (!apart)              assert (at == f_at && f_at < ITEMS);
    else                          assert (f_at - FILES_END < BITS);
  end

  // What a beat of bits writes back is what stood in its word, since no clock before the acknowledge has written.
  always @(posedge clk_i) if (f_past && PACKED && ack && bits && !apart && !$past(rst_i))
    assert (at == $past(at) && !$past(write));

  always @(posedge clk_i) if (f_past) begin
    cover (wb_ack_o && wb_we_i && $past(f_host_beat, 4));
    cover (host_err_o);
    cover (host_q && lent_q == 1'b0 && grant_ack_o && exception_o != 4'd0 && host_cyc_i);
  end
`endif

endmodule

`default_nettype wire
