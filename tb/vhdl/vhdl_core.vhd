-- SPDX-License-Identifier: Apache-2.0
-- Copyright (c) 2026 the project contributors
--
-- vhdl_core - modbus_rtu_core and modbus_bank_ram in VHDL, each field of the vectors on a port of its own: slave_bench.

library ieee;
use ieee.std_logic_1164.all;

use work.modbus_pkg.all;

entity vhdl_core is
  port (
    clk_i               : in  std_logic;
    rst_i               : in  std_logic;
    rxd_i               : in  std_logic;
    txd_o               : out std_logic;
    de_o                : out std_logic;

    address_i           : in  std_logic_vector(7 downto 0);
    bit_time_i          : in  std_logic_vector(15 downto 0);
    format_i            : in  std_logic_vector(1 downto 0);
    broadcast_en_i      : in  std_logic;
    gap_count_only_i    : in  std_logic;
    strict_turnaround_i : in  std_logic;
    drop_late_i         : in  std_logic;
    response_delay_i    : in  std_logic_vector(11 downto 0);
    stall_limit_i       : in  std_logic_vector(15 downto 0);
    de_lead_i           : in  std_logic_vector(3 downto 0);
    de_tail_i           : in  std_logic_vector(3 downto 0);

    busy_i              : in  std_logic;
    failure_i           : in  std_logic_vector(3 downto 0);
    exception_status_i  : in  std_logic_vector(7 downto 0);
    run_indicator_i     : in  std_logic;
    diagnostic_i        : in  std_logic_vector(15 downto 0);

    user_req_o          : out std_logic;
    user_count_o        : out std_logic_vector(7 downto 0);
    user_adr_i          : in  std_logic_vector(7 downto 0);
    user_dat_o          : out std_logic_vector(7 downto 0);
    user_put_i          : in  std_logic;
    user_dat_i          : in  std_logic_vector(7 downto 0);
    user_done_i         : in  std_logic;
    user_pass_i         : in  std_logic;
    user_exception_i    : in  std_logic_vector(3 downto 0);

    status_stb_i        : in  std_logic;
    status_adr_i        : in  std_logic_vector(6 downto 0);
    status_dat_o        : out std_logic_vector(15 downto 0);
    status_ack_o        : out std_logic;

    write_stb_o         : out std_logic;
    write_space_o       : out std_logic_vector(2 downto 0);
    write_first_o       : out std_logic_vector(15 downto 0);
    write_last_o        : out std_logic_vector(15 downto 0);
    write_file_o        : out std_logic_vector(15 downto 0);
    alive_o             : out std_logic;
    rx_active_o         : out std_logic;
    listen_only_o       : out std_logic;
    idle_o              : out std_logic;
    frame_stb_o         : out std_logic;
    err_parity_o        : out std_logic;
    err_framing_o       : out std_logic;
    err_overrun_o       : out std_logic;
    err_crc_o           : out std_logic;
    err_short_o         : out std_logic;
    err_long_o          : out std_logic;
    err_gap_o           : out std_logic;

    write_lock_i        : in  std_logic;
    host_cyc_i          : in  std_logic;
    host_stb_i          : in  std_logic;
    host_we_i           : in  std_logic;
    host_adr_i          : in  std_logic_vector(18 downto 0);
    host_dat_i          : in  std_logic_vector(15 downto 0);
    host_dat_o          : out std_logic_vector(15 downto 0);
    host_ack_o          : out std_logic;
    host_err_o          : out std_logic
  );
end entity vhdl_core;

architecture test of vhdl_core is

  signal settings   : mb_settings_vector;
  signal host_state : mb_host_state_vector;
  signal user_reply : mb_user_reply_vector;
  signal events     : mb_events_vector;

  signal grant_req, grant_write, grant_ack, wb_cyc, wb_stb, wb_we, wb_ack : std_logic;

  signal grant_space                        : std_logic_vector(2 downto 0);
  signal exception                          : std_logic_vector(3 downto 0);
  signal grant_first, grant_last, grant_file : std_logic_vector(15 downto 0);
  signal wb_write, wb_read                  : std_logic_vector(15 downto 0);
  signal wb_adr                             : std_logic_vector(18 downto 0);

begin

  settings <= mb_settings(
    address => address_i, bit_time => bit_time_i, format => format_i, broadcast => broadcast_en_i,
    gap_count_only => gap_count_only_i, strict => strict_turnaround_i, drop_late => drop_late_i,
    response_delay => response_delay_i, stall_limit => stall_limit_i, de_lead => de_lead_i, de_tail => de_tail_i
  );

  host_state <= mb_host_state(
    busy => busy_i, run => run_indicator_i, failure => failure_i, exception_status => exception_status_i,
    diagnostic => diagnostic_i(15 downto 1)
  );

  user_reply <= mb_user_reply(
    put => user_put_i, data => user_dat_i, done => user_done_i, pass => user_pass_i, exception => user_exception_i
  );

  frame_stb_o   <= events(MB_EVENT_FRAME);
  err_parity_o  <= events(MB_EVENT_PARITY);
  err_framing_o <= events(MB_EVENT_FRAMING);
  err_overrun_o <= events(MB_EVENT_OVERRUN);
  err_crc_o     <= events(MB_EVENT_CRC);
  err_short_o   <= events(MB_EVENT_SHORT);
  err_long_o    <= events(MB_EVENT_LONG);
  err_gap_o     <= events(MB_EVENT_GAP);

  write_space_o <= grant_space;
  write_first_o <= grant_first;
  write_last_o  <= grant_last;
  write_file_o  <= grant_file;

  u_core : modbus_rtu_core
    generic map (T15_MIN_US => 0, T35_MIN_US => 0, USER_CODES => mb_bit(65))
    port map (
      clk_i => clk_i, rst_i => rst_i, rxd_i => rxd_i, txd_o => txd_o, de_o => de_o, settings_i => settings,
      host_state_i => host_state, grant_req_o => grant_req, grant_space_o => grant_space, grant_first_o => grant_first,
      grant_last_o => grant_last, grant_write_o => grant_write, grant_file_o => grant_file, grant_ack_i => grant_ack,
      exception_i => exception, wb_cyc_o => wb_cyc, wb_stb_o => wb_stb, wb_we_o => wb_we, wb_adr_o => wb_adr,
      wb_dat_o => wb_write, wb_dat_i => wb_read, wb_ack_i => wb_ack, user_req_o => user_req_o,
      user_count_o => user_count_o, user_adr_i => user_adr_i, user_dat_o => user_dat_o, user_reply_i => user_reply,
      status_stb_i => status_stb_i, status_adr_i => status_adr_i, status_dat_o => status_dat_o,
      status_ack_o => status_ack_o, write_stb_o => write_stb_o, events_o => events, alive_o => alive_o,
      rx_active_o => rx_active_o, listen_only_o => listen_only_o, idle_o => idle_o
    );

  u_bank : modbus_bank_ram
    generic map (FILE_COUNT => 2, FILE_RECORDS => 8)
    port map (
      clk_i => clk_i, rst_i => rst_i, write_lock_i => write_lock_i, grant_req_i => grant_req,
      grant_space_i => grant_space, grant_first_i => grant_first, grant_last_i => grant_last,
      grant_write_i => grant_write, grant_file_i => grant_file, grant_ack_o => grant_ack, exception_o => exception,
      wb_cyc_i => wb_cyc, wb_stb_i => wb_stb, wb_we_i => wb_we, wb_adr_i => wb_adr, wb_dat_i => wb_write,
      wb_dat_o => wb_read, wb_ack_o => wb_ack, host_cyc_i => host_cyc_i, host_stb_i => host_stb_i,
      host_we_i => host_we_i, host_adr_i => host_adr_i, host_dat_i => host_dat_i, host_dat_o => host_dat_o,
      host_ack_o => host_ack_o, host_err_o => host_err_o
    );

end architecture test;
