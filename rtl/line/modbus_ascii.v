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
//   the character behind CR      t35_o, when its stop bits have ended: the frame ends; a bad one if the character is not
//                                the delimiter
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
  input  wire       rest_i,          // level : the stop bits of the last character have not ended

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
  reg       end_q = 1'b0;            // its last character came
  reg       close_q = 1'b0;          // the frame ends
  reg       colon_q = 1'b0;          // `:` came
  reg       start_q = 1'b0;          // a clock later: the frame before it has ended
  reg       up_q = 1'b0;

  // ------------------------------------------------------------------ received characters

  wire       is_colon = (data_i == COLON);
  wire       is_cr    = (data_i == CR);
  wire       ends     = (data_i == {1'b0, delimiter_q});
  wire       anew     = is_colon & ~(cr_q & ends);
  wire       of_byte  = ~cr_q & ~is_colon & ~is_cr;
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
  wire       big      = nibble[3] & (nibble[2] | nibble[1]);        // above 9
  wire       above_9  = ascii_i & began_q & ~last_i & big;
  // 30H to 39H have a low half up to 9; of 40H to 47H those that are letters A to F are worth more than 9.
  wire       of_a_digit  = data_i[5] & data_i[4] & ~big;
  wire       of_a_letter = ~data_i[5] & ~data_i[4] & ~data_i[3] & big;
  wire       allowed  = ~data_i[7] & (data_i[6] ? of_a_letter : of_a_digit);
  wire       misplaced = cr_q ? ~ends : is_colon ? any_q : is_cr ? half_q : ~allowed;
  wire       step     = valid_i ? ready_i & began_q : char_stb_i & of_byte;
  wire       fresh    = start_q | (valid_i & ~began_q);

  always @(posedge clk_i) begin
    half_q  <= ~ascii_i | (~fresh & (half_q ^ step));
    began_q <= ~ascii_i | (valid_i & (began_q | ready_i));
    if (step && half_q) sum_q <= sum_q + {high_q, nibble};
    if (fresh) sum_q <= 8'hFF;
    if (ascii_i ? step & ~half_q : char_stb_i) high_q <= ascii_i ? nibble : data_i[7:4];

    colon_q <= char_stb_i & (receiving_i ? anew : is_colon);
    start_q <= colon_q;
    up_q    <= open_stb_i & ascii_i;
    // Another character may begin before the stop bits should have ended.
    end_q   <= (heard & cr_q & ~anew) | (end_q & rest_i & ~start_stb_i);
    close_q <= (heard & anew & any_q) | (end_q & (start_stb_i | ~rest_i)) | over;
    any_q   <= ~start_q & (any_q | (heard & ~is_colon));
    cr_q    <= ~start_q & (heard ? is_cr : cr_q);
    wrong_q <= ~start_q & (wrong_q | (heard & misplaced) | over);

    if (delimiter_stb_i)    delimiter_q <= frame_byte_i[6:0];
    if (restart_i || rst_i) delimiter_q <= LF;
    if (rst_i) {colon_q, start_q, up_q, end_q, close_q} <= 5'd0;
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

`ifdef FORMAL
  // What the characters say, worked out another way; modbus_frame_rx, the frame RAM and modbus_frame_tx are assumed.
  function is_hex(input [7:0] c);
    is_hex = (c >= "0" && c <= "9") || (c >= "A" && c <= "F");
  endfunction
  function [3:0] value(input [7:0] c);
    reg [7:0] digit;
    begin
      digit = (c > "9") ? c - 8'h37 : c - 8'h30;
      value = digit[3:0];
    end
  endfunction

  reg       f_past = 1'b0;
  reg [2:0] f_quiet = 3'd0;          // clocks in which no character can end, nor the transmitter be ready
  reg       f_wrong = 1'b0;          // the frame has something it must not have
  reg       f_odd = 1'b0;            // half a byte has come
  reg       f_cr = 1'b0, f_any = 1'b0;
  reg [7:0] f_first = 8'd0;          // the character of the first half
  reg [7:0] f_sum = 8'd0;            // of all bytes, either way
  reg [7:0] f_byte = 8'd0;           // the last
  reg       f_whole = 1'b0;          // and it is complete since a clock
  reg       f_ended = 1'b0;          // the frame ended with CR and the delimiter
  reg       f_begun = 1'b0;          // a character is on the line
  reg       f_colon = 1'b0;          // what is sent: `:` has been,
  reg [1:0] f_checks = 2'd0;         // so many check bytes

  wire f_data = char_stb_i & receiving_i & ~f_cr & (data_i != ":") & (data_i != 8'h0D);
  wire f_take = valid_i & ready_i;
  wire [7:0] f_lrc = 8'd0 - f_sum;
  wire f_delimits = f_cr & (data_i == {1'b0, delimiter_q});

  always @(posedge clk_i) begin
    f_past  <= 1'b1;
    f_quiet <= (char_stb_i || f_take) ? 3'd6 : (f_quiet != 3'd0) ? f_quiet - 3'd1 : 3'd0;
    f_whole <= f_data & f_odd;
    f_begun <= start_stb_i | (f_begun & ~char_stb_i);
    f_ended <= (char_stb_i & receiving_i & f_delimits) | (f_ended & ~t35_o & ~start_q);
    if (char_stb_i && receiving_i) begin
      f_cr  <= (data_i == 8'h0D);
      f_any <= f_any | (data_i != ":");
      if (f_cr && !f_delimits)                         f_wrong <= 1'b1;
      if (data_i == ":" && !f_delimits && f_any)       f_wrong <= 1'b1;
      if (data_i == 8'h0D && !f_cr && f_odd) f_wrong <= 1'b1;
      if (f_data && !is_hex(data_i)) f_wrong <= 1'b1;
    end
    if (f_data) begin
      f_odd <= ~f_odd;
      if (!f_odd) f_first <= data_i;
      else begin
        f_byte <= {value(f_first), value(data_i)};
        f_sum  <= f_sum + {value(f_first), value(data_i)};
      end
    end
    if (start_q) {f_wrong, f_odd, f_cr, f_any, f_sum} <= 12'd0;
    if (valid_i) begin
      if (f_take) f_colon <= 1'b1;
      if (valid_i && ready_o && !check_i) f_sum <= f_sum + frame_byte_i;
      if (!f_colon) f_sum <= 8'd0;
      if (valid_i && ready_o && check_i) f_checks <= f_checks + 2'd1;
    end else {f_colon, f_checks} <= 3'd0;
    if (!ascii_i) {f_odd, f_cr, f_wrong} <= 3'd0;
  end

  always @* if (!f_past) assume (rst_i);
  always @(posedge clk_i) if (f_past) begin
    assume ($stable(ascii_i) && !rst_i);
    if (f_quiet != 3'd0) assume (!char_stb_i && !ready_i);
    if (char_stb_i)  assume (f_begun);
    if (start_stb_i) assume (!f_begun && !char_stb_i);
    if (over_i)      assume (!f_begun && f_quiet == 3'd0);       // silence is no character
    // The data stand until the next character ends, the byte to send until it was taken.
    if (!char_stb_i) assume ($stable(data_i));
    if ($past(valid_i) && !$past(ready_o)) assume (valid_i && $stable(frame_byte_i) && $stable(check_i) && $stable(last_i));
    if ($past(valid_i && f_take && ready_o) && f_quiet == 3'd5) assume ($stable(frame_byte_i));
    if (valid_i && ascii_i) assume (!receiving_i && !char_stb_i && !start_q && !colon_q);
    // A frame begins a clock behind the start and ends with its end.
    if (ascii_i) begin
      if ($past(start_stb_o) && !$past(valid_i)) assume (receiving_i);
      else if ($past(receiving_i && t35_o))      assume (!receiving_i);
      else                                       assume (receiving_i == $past(receiving_i) || $past(rst_i));
      if ($past(rst_i)) assume (!receiving_i && !valid_i);
    end
    // Bytes, then two check bytes
    if (last_i) assume (check_i && f_checks == 2'd1);
    if (valid_i && f_checks == 2'd1) assume (last_i);
    if (valid_i && !f_colon) assume (!check_i);
    assume (f_checks != 2'd2 || !valid_i);
    if (f_checks != 2'd0) assume (!valid_i || check_i);
    if ($past(delimiter_stb_i | restart_i)) assume (!receiving_i);
    if (delimiter_stb_i || restart_i) assume (!receiving_i && !char_stb_i && !start_q && !colon_q);
  end

  always @(posedge clk_i) if (f_past && !$past(rst_i)) begin
    if (!ascii_i) begin
      // RTU: as it comes
      assert (start_stb_o == start_stb_i && half_o && whole_o && check_ok_o == crc_zero_i);
      assert (t15_o == t15_i && t35_o == t35_i && ready_o == ready_i && check_o == check_i && !up_stb_o);
      if (valid_i && !check_i) assert (data_o == frame_byte_i);
      if ($past(char_stb_i) && !valid_i) assert (byte_o == $past(data_i));
    end else begin
      assert (!check_o);
      if (receiving_i && !start_q) begin
        assert (half_q == f_odd && cr_q == f_cr);
        assert (f_wrong == wrong_q || t35_o || t15_o || colon_q);
        assert (sum_q == f_sum - 8'd1 || f_wrong);
        if (f_odd) assert (high_q == value(f_first) || !is_hex(f_first));
      end
      // A whole byte
      if (char_stb_i && receiving_i) assert (whole_o == (f_data && f_odd) && half_o == f_data);
      if (f_whole && !f_wrong && receiving_i) assert (byte_o == f_byte);
      // A frame is good only if each character was allowed, CR and the delimiter end it, and the LRC is right.
      if (receiving_i && t35_o && check_ok_o) assert (f_ended && !f_wrong && !f_odd && f_sum == 8'd0);
      if (f_ended && receiving_i) assert (end_q || t35_o);
      if (f_ended && receiving_i && t35_o && !f_wrong && !f_odd && f_sum == 8'd0 && !wrong_q) assert (check_ok_o);
      // What is sent: `:`, two characters a byte, the LRC, CR LF
      if (valid_i) begin
        assert (began_q == f_colon);
        if (!f_colon) assert (data_o == ":" && !ready_o);
        else if (last_i) assert (data_o == (half_q ? 8'h0A : 8'h0D));
        else begin
          assert (is_hex(data_o));
          if (!check_i) assert (value(data_o) == (half_q ? frame_byte_i[3:0] : frame_byte_i[7:4]));
          else          assert (value(data_o) == (half_q ? f_lrc[3:0] : f_lrc[7:4]));
        end
        if (f_colon) assert (ready_o == (ready_i && half_q));
        if (f_colon && !check_i && !half_q) assert (sum_q == f_sum - 8'd1);
      end
    end
    cover (ascii_i && receiving_i && t35_o && check_ok_o && f_sum == 8'd0 && f_any);
    cover (ascii_i && last_i && f_take && half_q);
    cover (ascii_i && receiving_i && t15_o && t35_o);
  end
`endif

endmodule

`default_nettype wire
