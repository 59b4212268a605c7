// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_example_soc_axil - a SoC whose AXI4-Lite bus has two masters, the Modbus core and a CPU: a pattern to copy.
//
// modbus_axil_master makes the core a master.  The s_axil_* port is that of the CPU.  modbus_axil_slave with
// modbus_example_ram behind it stands for everything on the bus.  Both masters see one map, that of docs/buses.md.
//
// The arbiter takes one transfer at a time.  AXI4-Lite has no lock, so while burst_o of the bridge is high the arbiter
// takes nothing from the CPU, and all that a request does on the bus is one piece.  The CPU waits for one request at most,
// the core for one transfer of the CPU.  The line may have a request between two transfers of the CPU.
//
// No manner of the CPU can block the line: a write begins when its address and its data are both there, and its
// response, like the data of a read, waits in a register of the CPU's port, not on the bus.  A master that gives its
// address early and its data after a read of its own, or that does not take a response, holds up itself only.

`default_nettype none
`include "modbus_defs.vh"

module modbus_example_soc_axil #(
  parameter integer CLK_HZ     = 50000000,       // clk_i in hertz
  parameter integer T15_MIN_US = 750,            // floor of t1.5 in microseconds
  parameter integer T35_MIN_US = 1750,           // floor of t3.5 in microseconds
  parameter integer WORDS      = 128             // holding registers, and as many input registers
) (
  input  wire        clk_i,
  input  wire        rst_i,                      // synchronous, active high

  // Line
  input  wire        rxd_i,
  output wire        txd_o,
  output wire        de_o,
  input  wire [7:0]  address_i,
  input  wire [15:0] bit_time_i,                 // clocks per bit
  input  wire [1:0]  format_i,                   // 0 8E1, 1 8O1, 2 8N2, 3 8N1
  input  wire [15:0] stall_limit_i,              // bit times the bus may be silent: never 0 in a SoC

  // CPU: AXI4-Lite slave
  input  wire [20:0] s_axil_awaddr,
  input  wire [2:0]  s_axil_awprot,
  input  wire        s_axil_awvalid,
  output wire        s_axil_awready,
  input  wire [31:0] s_axil_wdata,
  input  wire [3:0]  s_axil_wstrb,
  input  wire        s_axil_wvalid,
  output wire        s_axil_wready,
  output wire [1:0]  s_axil_bresp,
  output wire        s_axil_bvalid,
  input  wire        s_axil_bready,
  input  wire [20:0] s_axil_araddr,
  input  wire [2:0]  s_axil_arprot,
  input  wire        s_axil_arvalid,
  output wire        s_axil_arready,
  output wire [31:0] s_axil_rdata,
  output wire [1:0]  s_axil_rresp,
  output wire        s_axil_rvalid,
  input  wire        s_axil_rready,

  // Board
  input  wire [7:0]  switches_i,
  output wire [7:0]  lamps_o
);

  // The example has no use for some outputs of the core.
  // verilator lint_off PINCONNECTEMPTY

  // Every function code but those of files
  localparam [127:0] CODES = `MB_ALL_FUNCTIONS & ~`MB_FILE_FUNCTIONS;

`include "modbus_bank_wires.vh"

  wire [`MB_SETTINGS_WIDTH-1:0] usual = `MB_LINE_SETTINGS(address_i, bit_time_i, format_i);
  reg  [`MB_SETTINGS_WIDTH-1:0] settings;

  always @* begin
    settings = usual;
    settings[`MB_SET_STALL_LIMIT] = stall_limit_i;
  end

  modbus_rtu_core #(
    .CLK_HZ(CLK_HZ), .T15_MIN_US(T15_MIN_US), .T35_MIN_US(T35_MIN_US), .FUNCTION_CODES(CODES)
  ) u_modbus (
    .clk_i(clk_i), .rst_i(rst_i), .rxd_i(rxd_i), .txd_o(txd_o), .de_o(de_o), .settings_i(settings),
    .host_state_i(`MB_HOST_AT_REST), .user_req_o(), .user_count_o(), .user_adr_i(8'd0), .user_dat_o(),
    .user_reply_i(`MB_NO_USER), .status_stb_i(1'b0), .status_adr_i(7'd0), .status_dat_o(), .status_ack_o(),
    .write_stb_o(), .events_o(), .alive_o(), .rx_active_o(), .listen_only_o(), .unit_o(), .idle_o(),
`include "modbus_bank_core_inst.vh"
  );

  // The core as a master; addresses above the map's 2 MiB are 0 here, for the map begins at 0
  wire [31:0] line_awaddr, line_araddr, line_wdata;
  wire [3:0]  line_wstrb;
  wire        line_awvalid, line_wvalid, line_bready, line_arvalid, line_rready, burst;
  wire [2:0]  line_awprot, line_arprot;

  // The bus behind the arbiter
  wire        awvalid, awready, wvalid, wready, bvalid, bready, arvalid, arready, rvalid, rready;
  wire [1:0]  bresp, rresp;
  wire [31:0] rdata;

  // Whose transfer it is, and what of it the bus has taken
  localparam [1:0] ST_IDLE = 2'd0, ST_WRITE = 2'd1, ST_READ = 2'd2;
  reg [1:0] state_q = ST_IDLE;
  reg       line_q = 1'b0;                       // it is the core's
  reg       write_q = 1'b0;                      // the last one was a write
  reg       address_q, data_q;                   // taken: address, data

  // Responses for the CPU, until it takes them
  reg        cpu_bvalid_q = 1'b0, cpu_rvalid_q = 1'b0;
  reg [1:0]  cpu_bresp_q, cpu_rresp_q;
  reg [31:0] cpu_rdata_q;

  modbus_axil_master #(
    .COIL_COUNT(8), .DISCRETE_COUNT(8), .INPUT_COUNT(WORDS), .HOLDING_COUNT(WORDS)
  ) u_bridge (
    .clk_i(clk_i), .rst_i(rst_i), .write_lock_i(1'b0),
`include "modbus_bank_inst.vh"
    ,
    .burst_o(burst), .hung_o(),
    .m_axil_awaddr(line_awaddr), .m_axil_awprot(line_awprot), .m_axil_awvalid(line_awvalid),
    .m_axil_awready(line_q & awready), .m_axil_wdata(line_wdata), .m_axil_wstrb(line_wstrb),
    .m_axil_wvalid(line_wvalid), .m_axil_wready(line_q & wready), .m_axil_bresp(bresp),
    .m_axil_bvalid(line_q & bvalid), .m_axil_bready(line_bready), .m_axil_araddr(line_araddr),
    .m_axil_arprot(line_arprot), .m_axil_arvalid(line_arvalid), .m_axil_arready(line_q & arready),
    .m_axil_rdata(rdata), .m_axil_rresp(rresp), .m_axil_rvalid(line_q & rvalid), .m_axil_rready(line_rready)
  );

  // Arbiter
  wire line_wants = line_awvalid | line_arvalid;
  wire cpu_writes = s_axil_awvalid & s_axil_wvalid & ~cpu_bvalid_q;
  wire cpu_reads  = s_axil_arvalid & ~cpu_rvalid_q;
  wire writing = (state_q == ST_WRITE), reading = (state_q == ST_READ);
  wire ends = (bvalid & bready) | (rvalid & rready);

  always @(posedge clk_i) begin
    case (state_q)
      // The bus is free.  A CPU that always wants both reads and writes in turn.
      ST_IDLE: begin
        line_q    <= line_wants;
        address_q <= 1'b0;
        data_q    <= 1'b0;
        if (line_wants)  state_q <= line_awvalid ? ST_WRITE : ST_READ;
        else if (!burst) begin
          if (cpu_writes && !(cpu_reads && write_q)) state_q <= ST_WRITE;
          else if (cpu_reads)                        state_q <= ST_READ;
        end
      end
      // Address and data are taken in any order, then the response goes back.
      ST_WRITE, ST_READ: begin
        if ((awvalid & awready) | (arvalid & arready)) address_q <= 1'b1;
        if (wvalid & wready) data_q <= 1'b1;
        if (ends) state_q <= ST_IDLE;
      end
      default: state_q <= ST_IDLE;
    endcase
    if (state_q != ST_IDLE) write_q <= writing;

    if (~line_q & writing & bvalid) cpu_bresp_q <= bresp;
    if (~line_q & reading & rvalid) {cpu_rresp_q, cpu_rdata_q} <= {rresp, rdata};
    cpu_bvalid_q <= (~line_q & writing & bvalid) | (cpu_bvalid_q & ~s_axil_bready);
    cpu_rvalid_q <= (~line_q & reading & rvalid) | (cpu_rvalid_q & ~s_axil_rready);

    if (rst_i) begin
      state_q      <= ST_IDLE;
      line_q       <= 1'b0;
      cpu_bvalid_q <= 1'b0;
      cpu_rvalid_q <= 1'b0;
    end
  end

  assign awvalid = writing & ~address_q & (line_q ? line_awvalid : s_axil_awvalid);
  assign wvalid  = writing & ~data_q & (line_q ? line_wvalid : s_axil_wvalid);
  assign bready  = writing & (~line_q | line_bready);
  assign arvalid = reading & ~address_q & (line_q ? line_arvalid : s_axil_arvalid);
  assign rready  = reading & (~line_q | line_rready);

  // To the bridge "ready" counts only with its valid on the bus, and so to the CPU.
  assign s_axil_awready = ~line_q & writing & ~address_q & awready;
  assign s_axil_wready  = ~line_q & writing & ~data_q & wready;
  assign s_axil_bresp   = cpu_bresp_q;
  assign s_axil_bvalid  = cpu_bvalid_q;
  assign s_axil_arready = ~line_q & reading & ~address_q & arready;
  assign s_axil_rdata   = cpu_rdata_q;
  assign s_axil_rresp   = cpu_rresp_q;
  assign s_axil_rvalid  = cpu_rvalid_q;

  // What is on the bus
  wire        ram_cyc, ram_stb, ram_we, ram_ack, ram_err;
  wire [18:0] ram_adr;
  wire [15:0] ram_write, ram_read;

  modbus_axil_slave #(.HOLD(0)) u_slave (
    .clk_i(clk_i), .rst_i(rst_i),
    .s_axil_awaddr(line_q ? line_awaddr[20:0] : s_axil_awaddr), .s_axil_awprot(line_q ? line_awprot : s_axil_awprot),
    .s_axil_awvalid(awvalid), .s_axil_awready(awready), .s_axil_wdata(line_q ? line_wdata : s_axil_wdata),
    .s_axil_wstrb(line_q ? line_wstrb : s_axil_wstrb), .s_axil_wvalid(wvalid), .s_axil_wready(wready),
    .s_axil_bresp(bresp), .s_axil_bvalid(bvalid), .s_axil_bready(bready),
    .s_axil_araddr(line_q ? line_araddr[20:0] : s_axil_araddr), .s_axil_arprot(line_q ? line_arprot : s_axil_arprot),
    .s_axil_arvalid(arvalid), .s_axil_arready(arready), .s_axil_rdata(rdata), .s_axil_rresp(rresp),
    .s_axil_rvalid(rvalid), .s_axil_rready(rready),
    .host_cyc_o(ram_cyc), .host_stb_o(ram_stb), .host_we_o(ram_we), .host_adr_o(ram_adr), .host_dat_o(ram_write),
    .host_dat_i(ram_read), .host_ack_i(ram_ack), .host_err_i(ram_err)
  );

  modbus_example_ram #(.WORDS(WORDS)) u_ram (
    .clk_i(clk_i), .rst_i(rst_i), .wb_cyc_i(ram_cyc), .wb_stb_i(ram_stb), .wb_we_i(ram_we), .wb_adr_i(ram_adr),
    .wb_dat_i(ram_write), .wb_dat_o(ram_read), .wb_ack_o(ram_ack), .wb_err_o(ram_err), .switches_i(switches_i),
    .lamps_o(lamps_o)
  );

  wire unused = &{1'b0, line_awaddr[31:21], line_araddr[31:21]};

  // verilator lint_on PINCONNECTEMPTY

endmodule

`default_nettype wire
