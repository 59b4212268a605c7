-- SPDX-License-Identifier: Apache-2.0
-- Copyright (c) 2026 the project contributors
--
-- vhdl_ram - modbus_rtu_slave in VHDL, each setting other than its default.

library ieee;
use ieee.std_logic_1164.all;

use work.modbus_pkg.all;

entity vhdl_ram is
  port (
    clk_i         : in  std_logic;
    rst_i         : in  std_logic;
    rxd_i         : in  std_logic;
    txd_o         : out std_logic;
    de_o          : out std_logic;
    host_cyc_i    : in  std_logic;
    host_stb_i    : in  std_logic;
    host_we_i     : in  std_logic;
    host_adr_i    : in  std_logic_vector(18 downto 0);
    host_dat_i    : in  std_logic_vector(15 downto 0);
    host_dat_o    : out std_logic_vector(15 downto 0);
    host_ack_o    : out std_logic;
    host_err_o    : out std_logic;
    write_stb_o   : out std_logic;
    write_space_o : out std_logic_vector(2 downto 0);
    write_first_o : out std_logic_vector(15 downto 0);
    write_last_o  : out std_logic_vector(15 downto 0);
    write_file_o  : out std_logic_vector(15 downto 0);
    alive_o       : out std_logic
  );
end entity vhdl_ram;

architecture test of vhdl_ram is
begin

  u_modbus : modbus_rtu_slave
    generic map (
      CLK_HZ => 1000000, BAUD => 62500, ADDRESS => 247, FORMAT => 3, BROADCAST => 0, GAP_COUNT_ONLY => 1,
      STRICT_TURNAROUND => 1, RESPONSE_DELAY => 5, DE_LEAD => 3, DE_TAIL => 2, T15_MIN_US => 0, T35_MIN_US => 0,
      FUNCTION_CODES => MB_ALL_FUNCTIONS and not mb_bit(MB_FC_READ_FIFO_QUEUE), COIL_COUNT => 40, HOLDING_BASE => 100,
      HOLDING_COUNT => 50
    )
    port map (
      clk_i => clk_i, rst_i => rst_i, rxd_i => rxd_i, txd_o => txd_o, de_o => de_o, host_cyc_i => host_cyc_i,
      host_stb_i => host_stb_i, host_we_i => host_we_i, host_adr_i => host_adr_i, host_dat_i => host_dat_i,
      host_dat_o => host_dat_o, host_ack_o => host_ack_o, host_err_o => host_err_o, write_stb_o => write_stb_o,
      write_space_o => write_space_o, write_first_o => write_first_o, write_last_o => write_last_o,
      write_file_o => write_file_o, alive_o => alive_o
    );

end architecture test;
