// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_ascii - ASCII mode: between the characters of the line and the bytes and silences that RTU has.
//
// A frame is `:`, two hexadecimal characters (0-9, A-F) for each byte, the LRC last, then CR and the delimiter, which is
// LF or what 08/0003 has set (MODBUS over Serial Line V1.02, clause 2.5.2).  modbus_frame_rx gets what RTU would give:
//
//   `:`                          start_stb_o: a frame begins.  A `:` inside a frame first ends that as a bad one, unless
//                                nothing has come since its own `:`
//   a character for half a byte  half_o with the character's strobe, whole_o too with the second: byte_o is complete
//   the character behind CR      t35_o: the frame ends; a bad one if the character is not the delimiter
//   silence above the time-out   t15_o, then t35_o: the frame ends as a bad one
//
// up_stb_o makes up for the second check byte that RTU has.  check_ok_o is the verdict on the LRC and the characters.
// Characters outside a frame are ignored.
//
// Sending, modbus_frame_tx offers bytes and then two check bytes.  `:` goes before the first byte, each byte goes as two
// characters, the first check byte as the LRC and the second as CR LF.
//
// With ascii_i low everything passes unchanged.  The line is half duplex, so both ways share the LRC and the half.

`default_nettype none

module modbus_ascii (
  input  wire       clk_i,
  input  wire       rst_i,
  input  wire       ascii_i,         // level : ASCII mode, 0: RTU

  // The delimiter
  input  wire       delimiter_stb_i, // strobe: it is frame_byte_i from now on, without bit 7
  input  wire       restart_i,       // strobe: it is LF again

  // Received characters
  input  wire       receiving_i,     // level : a frame is being received
  input  wire       open_stb_i,      // strobe: it begins: the frame RAM counts from 0
  input  wire       start_stb_i,     // strobe: a start bit
  input  wire       char_stb_i,      // strobe: a character is complete
  input  wire [7:0] data_i,          // level : it
  input  wire       crc_zero_i,
  input  wire       t15_i,
  input  wire       t35_i,
  input  wire       over_i,          // level : silent for longer than the time-out

  // To the frame receiver
  output wire       start_stb_o,     // strobe: a character that begins or continues a frame
  output wire       half_o,          // level : with char_stb_i, it belongs to a byte
  output wire       whole_o,         // level : with char_stb_i, it completes the byte
  output wire [7:0] byte_o,          // level : the byte, until the next character
  output wire       up_stb_o,        // strobe: one byte more than there is
  output wire       check_ok_o,      // level : the check field is right
  output wire       t15_o,
  output wire       t35_o,

  // Bytes to send
  input  wire       valid_i,
  input  wire       check_i,         // level : a check byte
  input  wire       last_i,          // level : the second check byte
  input  wire [7:0] frame_byte_i,
  output wire       ready_o,

  // To the transmitter
  output wire [7:0] data_o,
  output wire       check_o,         // level : send check bits of the CRC
  input  wire       ready_i
);

  localparam [7:0] COLON = 8'h3A, CR = 8'h0D;
  localparam [6:0] LF = 7'h0A;

  reg [6:0] delimiter_q = LF;
  reg [3:0] high_q;                  // high half of the byte
  reg [7:0] sum_q;                   // sum of the bytes that have passed, less 1: inverted it is the LRC
  reg       half_q = 1'b1;           // the high half of a byte has passed; RTU: 1
  reg       began_q = 1'b1;          // `:` was sent; RTU: 1
  reg       any_q = 1'b0;            // something came since `:`
  reg       cr_q = 1'b0;             // CR came
  reg       wrong_q = 1'b0;          // the frame has a character it must not have, or too few
  reg       close_q = 1'b0;          // the frame ends
  reg       colon_q = 1'b0;          // `:` came
  reg       start_q = 1'b0;          // a clock later: the frame before it has ended
  reg       up_q = 1'b0;

  // ------------------------------------------------------------------ received characters

  wire       is_colon = (data_i == COLON);
  wire       is_cr    = (data_i == CR);
  wire       ends     = (data_i == {1'b0, delimiter_q});
  wire       digit    = (data_i[7:4] == 4'h3) & ~(data_i[3] & (data_i[2] | data_i[1]));
  wire       capital  = (data_i[7:3] == 5'h08) & (data_i[2:0] != 3'd0) & (data_i[2:0] != 3'd7);
  wire       of_byte  = ~cr_q & ~is_colon & ~is_cr;
  wire       misplaced = cr_q ? ~ends : is_colon ? any_q : is_cr ? half_q : ~(digit | capital);
  wire       heard    = char_stb_i & receiving_i;
  wire       over     = over_i & receiving_i;
  // A is 41H: a letter is 9 more than its low half.
  wire       letter   = data_i[6] & ascii_i;
  wire [3:0] received = {data_i[3] | letter, data_i[2] ^ (letter & data_i[1] & data_i[0]),
                         data_i[1] ^ (letter & data_i[0]), data_i[0] ^ letter};

  // ------------------------------------------------------------------ characters to send

  // CR is 0DH, LF is 0AH, and `:` is 3AH: the digit that A would be.
  wire       cr_tx    = last_i & ~half_q;
  wire [3:0] sent     = (last_i | ~began_q) ? {1'b1, cr_tx, ~cr_tx, cr_tx} :
                        check_i             ? (half_q ? ~sum_q[3:0] : ~sum_q[7:4]) :
                                              (half_q ? frame_byte_i[3:0] : frame_byte_i[7:4]);

  // ------------------------------------------------------------------ halves of bytes, either way

  wire [3:0] nibble   = valid_i ? sent : received;
  wire       above_9  = ascii_i & began_q & ~last_i & nibble[3] & (nibble[2] | nibble[1]);
  wire       step     = valid_i ? ready_i & began_q : char_stb_i & of_byte;
  wire       fresh    = start_q | (valid_i & ~began_q);

  always @(posedge clk_i) begin
    if (step) half_q <= ~half_q;
    if (step && half_q) sum_q <= sum_q + {high_q, nibble};
    if (fresh) begin
      half_q <= 1'b0;
      sum_q  <= 8'hFF;
    end
    if (ascii_i ? step & ~half_q : char_stb_i) high_q <= ascii_i ? nibble : data_i[7:4];
    began_q <= valid_i & (began_q | ready_i);
    if (!ascii_i) {half_q, began_q} <= 2'b11;

    colon_q <= char_stb_i & is_colon & ~(receiving_i & cr_q & ends);
    start_q <= colon_q;
    up_q    <= open_stb_i & ascii_i;
    close_q <= (heard & (cr_q | (is_colon & any_q))) | over;
    if (heard) begin
      any_q <= any_q | ~is_colon;
      cr_q  <= is_cr;
    end
    if ((heard && misplaced) || over) wrong_q <= 1'b1;
    if (start_q) {any_q, cr_q, wrong_q} <= 3'b000;

    if (delimiter_stb_i)    delimiter_q <= frame_byte_i[6:0];
    if (restart_i || rst_i) delimiter_q <= LF;
    if (rst_i) {colon_q, start_q, up_q, close_q} <= 4'd0;
  end

  assign start_stb_o = ascii_i ? start_q : start_stb_i;
  assign half_o      = of_byte | ~ascii_i;
  assign whole_o     = half_o & half_q;
  assign byte_o      = {high_q, nibble};
  assign up_stb_o    = up_q;
  assign check_ok_o  = ascii_i ? (sum_q == 8'hFF) & ~wrong_q : crc_zero_i;
  assign t15_o       = ascii_i ? over_i : t15_i;
  assign t35_o       = ascii_i ? close_q : t35_i;
  assign ready_o     = ready_i & (~valid_i | (half_q & began_q));
  assign check_o     = check_i & ~ascii_i;
  // 9 more than a half above 9 has a low half of 1 to 6.
  assign data_o      = {frame_byte_i[7] & ~ascii_i,
                        ascii_i ? above_9 : frame_byte_i[6],
                        ascii_i ? ~above_9 & ~last_i : frame_byte_i[5],
                        ascii_i ? ~above_9 & ~last_i : frame_byte_i[4],
                        nibble[3] & ~above_9,
                        nibble[2] & ~(above_9 & ~nibble[1] & ~nibble[0]),
                        nibble[1] ^ (above_9 & ~nibble[0]),
                        nibble[0] ^ above_9};

endmodule

`default_nettype wire
