-- SPDX-License-Identifier: Apache-2.0
-- Copyright (c) 2026 the project contributors
--
-- vhdl_io - modbus_rtu_slave_io as a VHDL user instantiates it, its reset and some of its settings beside.

library ieee;
use ieee.std_logic_1164.all;

use work.modbus_pkg.all;

entity vhdl_io is
  port (
    clk_i       : in  std_logic;
    rst_i       : in  std_logic;
    rxd_i       : in  std_logic;
    txd_o       : out std_logic;
    de_o        : out std_logic;
    coils_o     : out std_logic_vector(15 downto 0);
    discretes_i : in  std_logic_vector(15 downto 0);
    inputs_i    : in  std_logic_vector(127 downto 0);
    holdings_o  : out std_logic_vector(127 downto 0);
    alive_o     : out std_logic
  );
end entity vhdl_io;

architecture test of vhdl_io is
begin

  u_modbus : modbus_rtu_slave_io
    generic map (
      CLK_HZ => 2000000, BAUD => 250000, ADDRESS => 17, T15_MIN_US => 0, T35_MIN_US => 0, VENDOR_NAME => "VHDL users",
      ADDITIONAL_DATA => mb_text("tail", 250), ADDITIONAL_DATA_BYTES => 4
    )
    port map (
      clk_i => clk_i, rst_i => rst_i, rxd_i => rxd_i, txd_o => txd_o, de_o => de_o, coils_o => coils_o,
      discretes_i => discretes_i, inputs_i => inputs_i, holdings_o => holdings_o, alive_o => alive_o
    );

end architecture test;
