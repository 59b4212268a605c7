-- SPDX-License-Identifier: Apache-2.0
-- Copyright (c) 2026 the project contributors
--
-- modbus_pkg - the core for a VHDL design: components of the tops and banks, names and functions for their vectors.
--
-- VHDL-93.  The components have the names of the Verilog modules, so tools that take both languages bind them by
-- themselves.  An input that need not be connected has a default: a user of modbus_rtu_slave_io connects clock, line
-- and data.  Names that begin with MB_ are those of rtl/include/modbus_defs.vh.
--
-- Made by tools/vhdl_package.py --update: change the Verilog, not this file.

library ieee;
use ieee.std_logic_1164.all;

package modbus_pkg is

  subtype mb_codes is std_logic_vector(127 downto 0);

  -- Function codes
  constant MB_FC_READ_COILS               : natural := 16#01#;
  constant MB_FC_READ_DISCRETE_INPUTS     : natural := 16#02#;
  constant MB_FC_READ_HOLDING_REGISTERS   : natural := 16#03#;
  constant MB_FC_READ_INPUT_REGISTERS     : natural := 16#04#;
  constant MB_FC_WRITE_SINGLE_COIL        : natural := 16#05#;
  constant MB_FC_WRITE_SINGLE_REGISTER    : natural := 16#06#;
  constant MB_FC_READ_EXCEPTION_STATUS    : natural := 16#07#;
  constant MB_FC_DIAGNOSTICS              : natural := 16#08#;
  constant MB_FC_GET_EVENT_COUNTER        : natural := 16#0B#;
  constant MB_FC_GET_EVENT_LOG            : natural := 16#0C#;
  constant MB_FC_WRITE_MULTIPLE_COILS     : natural := 16#0F#;
  constant MB_FC_WRITE_MULTIPLE_REGISTERS : natural := 16#10#;
  constant MB_FC_REPORT_SERVER_ID         : natural := 16#11#;
  constant MB_FC_READ_FILE_RECORD         : natural := 16#14#;
  constant MB_FC_WRITE_FILE_RECORD        : natural := 16#15#;
  constant MB_FC_MASK_WRITE_REGISTER      : natural := 16#16#;
  constant MB_FC_READ_WRITE_REGISTERS     : natural := 16#17#;
  constant MB_FC_READ_FIFO_QUEUE          : natural := 16#18#;
  constant MB_FC_ENCAPSULATED             : natural := 16#2B#;

  -- Sets of them: bit n is function code n
  constant MB_COIL_FUNCTIONS       : mb_codes := x"00000000000000000000000000008022";
  constant MB_DISCRETE_FUNCTIONS   : mb_codes := x"00000000000000000000000000000004";
  constant MB_INPUT_FUNCTIONS      : mb_codes := x"00000000000000000000000000000010";
  constant MB_HOLDING_FUNCTIONS    : mb_codes := x"00000000000000000000000001C10048";
  constant MB_FILE_FUNCTIONS       : mb_codes := x"00000000000000000000000000300000";
  constant MB_DIAGNOSTIC_FUNCTIONS : mb_codes := x"00000000000000000000000000001900";
  constant MB_IDENTITY_FUNCTIONS   : mb_codes := x"00000000000000000000080000020000";
  constant MB_ALL_FUNCTIONS        : mb_codes := x"00000000000000000000080001F399FE";

  -- Exception codes
  constant MB_EX_ILLEGAL_FUNCTION     : std_logic_vector(3 downto 0) := x"1";
  constant MB_EX_ILLEGAL_DATA_ADDRESS : std_logic_vector(3 downto 0) := x"2";
  constant MB_EX_ILLEGAL_DATA_VALUE   : std_logic_vector(3 downto 0) := x"3";
  constant MB_EX_DEVICE_FAILURE       : std_logic_vector(3 downto 0) := x"4";
  constant MB_EX_ACKNOWLEDGE          : std_logic_vector(3 downto 0) := x"5";
  constant MB_EX_DEVICE_BUSY          : std_logic_vector(3 downto 0) := x"6";
  constant MB_EX_NEGATIVE_ACKNOWLEDGE : std_logic_vector(3 downto 0) := x"7";

  -- Spaces
  constant MB_SPACE_COILS          : std_logic_vector(2 downto 0) := "000";
  constant MB_SPACE_DISCRETES      : std_logic_vector(2 downto 0) := "001";
  constant MB_SPACE_INPUTS         : std_logic_vector(2 downto 0) := "010";
  constant MB_SPACE_HOLDINGS       : std_logic_vector(2 downto 0) := "011";
  constant MB_SPACE_FILES          : std_logic_vector(2 downto 0) := "100";
  constant MB_SPACE_CHECK_COILS    : std_logic_vector(2 downto 0) := "110";
  constant MB_SPACE_CHECK_HOLDINGS : std_logic_vector(2 downto 0) := "111";
  constant MB_SPACE_CORE           : std_logic_vector(2 downto 0) := "101";

  -- Formats
  constant MB_FORMAT_8E1 : std_logic_vector(1 downto 0) := "00";
  constant MB_FORMAT_8O1 : std_logic_vector(1 downto 0) := "01";
  constant MB_FORMAT_8N2 : std_logic_vector(1 downto 0) := "10";
  constant MB_FORMAT_8N1 : std_logic_vector(1 downto 0) := "11";

  -- settings_i
  constant MB_SETTINGS_WIDTH : natural := 74;
  subtype mb_settings_vector is std_logic_vector(MB_SETTINGS_WIDTH - 1 downto 0);
  function mb_settings (
    address        : std_logic_vector(7 downto 0);
    bit_time       : std_logic_vector(15 downto 0);
    format         : std_logic_vector(1 downto 0)  := "00";
    broadcast      : std_logic                     := '1';
    gap_count_only : std_logic                     := '0';
    strict         : std_logic                     := '0';
    drop_late      : std_logic                     := '0';
    response_delay : std_logic_vector(11 downto 0) := x"000";
    stall_limit    : std_logic_vector(15 downto 0) := x"0000";
    de_lead        : std_logic_vector(3 downto 0)  := x"1";
    de_tail        : std_logic_vector(3 downto 0)  := x"0";
    bit_fraction   : std_logic_vector(3 downto 0)  := x"0";
    ascii          : std_logic                     := '0';
    eight_bits     : std_logic                     := '0';
    ascii_extra    : std_logic_vector(1 downto 0)  := "00"
  ) return mb_settings_vector;

  -- host_state_i
  constant MB_HOST_STATE_WIDTH : natural := 30;
  subtype mb_host_state_vector is std_logic_vector(MB_HOST_STATE_WIDTH - 1 downto 0);
  constant MB_HOST_AT_REST : mb_host_state_vector := "000000000000000000000000000010";
  function mb_host_state (
    busy             : std_logic                     := '0';
    run              : std_logic                     := '1';
    failure          : std_logic_vector(3 downto 0)  := x"0";
    exception_status : std_logic_vector(7 downto 0)  := x"00";
    diagnostic       : std_logic_vector(14 downto 0) := "000000000000000";
    unit_ours        : std_logic                     := '0'
  ) return mb_host_state_vector;

  -- events_o
  constant MB_EVENTS_WIDTH : natural := 8;
  subtype mb_events_vector is std_logic_vector(MB_EVENTS_WIDTH - 1 downto 0);
  constant MB_EVENT_FRAME   : natural := 0;
  constant MB_EVENT_PARITY  : natural := 1;
  constant MB_EVENT_FRAMING : natural := 2;
  constant MB_EVENT_OVERRUN : natural := 3;
  constant MB_EVENT_CRC     : natural := 4;
  constant MB_EVENT_SHORT   : natural := 5;
  constant MB_EVENT_LONG    : natural := 6;
  constant MB_EVENT_GAP     : natural := 7;

  -- user_reply_i
  constant MB_USER_REPLY_WIDTH : natural := 15;
  subtype mb_user_reply_vector is std_logic_vector(MB_USER_REPLY_WIDTH - 1 downto 0);
  constant MB_NO_USER : mb_user_reply_vector := "000000000000000";
  function mb_user_reply (
    put       : std_logic;
    done      : std_logic;
    pass      : std_logic                    := '0';
    exception : std_logic_vector(3 downto 0) := x"0";
    data      : std_logic_vector(7 downto 0)
  ) return mb_user_reply_vector;

  -- The set of one function code; join sets by `or`
  function mb_bit (code : natural) return mb_codes;

  -- The bit time of a rate, rounded to whole clocks
  function mb_bit_time (clk_hz : positive; baud : positive) return std_logic_vector;

  -- The characters of `text`, right-justified in `bytes` bytes: for ADDITIONAL_DATA, SERVER_ID, PRIVATE_OBJECTS
  function mb_text (text : string; bytes : positive) return std_logic_vector;

  component modbus_rtu_slave_io is
    generic (
      LINE_HEALTH           : natural                         := 0;
      HEALTH_COIL           : natural                         := 65536;
      ADDRESS               : natural                         := 1;
      BAUD                  : natural                         := 19200;
      FORMAT                : natural                         := 0;
      BROADCAST             : natural                         := 1;
      GAP_COUNT_ONLY        : natural                         := 0;
      STRICT_TURNAROUND     : natural                         := 0;
      DROP_LATE             : natural                         := 0;
      RESPONSE_DELAY        : natural                         := 0;
      STALL_LIMIT           : natural                         := 0;
      DE_LEAD               : natural                         := 1;
      DE_TAIL               : natural                         := 0;
      ASCII                 : natural                         := 0;
      ASCII_DATA_BITS       : natural                         := 7;
      ASCII_EXTRA           : natural                         := 0;
      COIL_BASE             : natural                         := 0;
      COIL_COUNT            : natural                         := 16;
      DISCRETE_BASE         : natural                         := 0;
      DISCRETE_COUNT        : natural                         := 16;
      INPUT_BASE            : natural                         := 0;
      INPUT_COUNT           : natural                         := 8;
      HOLDING_BASE          : natural                         := 0;
      HOLDING_COUNT         : natural                         := 8;
      READ_ONLY_BASE        : natural                         := 0;
      READ_ONLY_COUNT       : natural                         := 0;
      FILE_COUNT            : natural                         := 0;
      FILE_RECORDS          : natural                         := 256;
      OVERLAY               : natural                         := 0;
      READ_BACK_RAM         : natural                         := 0;
      CLK_HZ                : natural                         := 50000000;
      T15_MIN_US            : natural                         := 750;
      T35_MIN_US            : natural                         := 1750;
      MAX_BIT_TIME          : natural                         := 65535;
      BIT_FRACTIONS         : natural                         := 0;
      GLITCH_FILTER         : natural                         := 0;
      UNIT_SET              : std_logic_vector(247 downto 0)  := (others => '0');
      UNIT_PORT             : natural                         := 0;
      ASCII_MODE            : natural                         := 0;
      ASCII_TIMEOUT_MS      : natural                         := 1000;
      FUNCTION_CODES        : mb_codes                        := x"00000000000000000000080001F399FE";
      USER_CODES            : mb_codes                        := x"00000000000000000000000000000000";
      MAX_READ_BITS         : natural                         := 2000;
      MAX_WRITE_BITS        : natural                         := 1968;
      MAX_READ_REGISTERS    : natural                         := 125;
      MAX_WRITE_REGISTERS   : natural                         := 123;
      RW_MAX_READ           : natural                         := 125;
      RW_MAX_WRITE          : natural                         := 121;
      BITS_PER_BEAT         : natural                         := 1;
      CHECK_WRITES          : natural                         := 0;
      SERVER_ID             : std_logic_vector(127 downto 0)  := x"00000000000000000000000000000009";
      SERVER_ID_BYTES       : natural                         := 1;
      ADDITIONAL_DATA       : std_logic_vector(1999 downto 0) := (others => '0');
      ADDITIONAL_DATA_BYTES : natural                         := 0;
      VENDOR_NAME           : string                          := "VENDOR";
      PRODUCT_CODE          : string                          := "PRODUCT";
      REVISION              : string                          := "V1.0";
      VENDOR_URL            : string                          := "";
      PRODUCT_NAME          : string                          := "";
      MODEL_NAME            : string                          := "";
      USER_APPLICATION_NAME : string                          := "";
      PRIVATE_OBJECTS       : std_logic_vector(4095 downto 0) := (others => '0');
      CONFORMITY            : std_logic_vector(7 downto 0)    := x"81";
      DEVICE_ID_LIMIT       : natural                         := 253;
      ALIVE_TIMEOUT_MS      : natural                         := 0
    );
    port (
      clk_i       : in  std_logic;
      rst_i       : in  std_logic := '0';
      rxd_i       : in  std_logic;
      txd_o       : out std_logic;
      de_o        : out std_logic;
      coils_o     : out std_logic_vector(COIL_COUNT + boolean'pos(COIL_COUNT = 0) - 1 downto 0);
      discretes_i : in  std_logic_vector(DISCRETE_COUNT + boolean'pos(DISCRETE_COUNT = 0) - 1 downto 0)
        := (others => '0');
      inputs_i    : in  std_logic_vector(16 * (INPUT_COUNT + boolean'pos(INPUT_COUNT = 0)) - 1 downto 0)
        := (others => '0');
      holdings_o  : out std_logic_vector(16 * (HOLDING_COUNT + boolean'pos(HOLDING_COUNT = 0)) - 1 downto 0);
      alive_o     : out std_logic
    );
  end component modbus_rtu_slave_io;

  component modbus_rtu_slave is
    generic (
      HOST_MAP              : natural                         := 1;
      HOST_SETTINGS         : natural                         := 0;
      LINE_HEALTH           : natural                         := 0;
      ADDRESS               : natural                         := 1;
      BAUD                  : natural                         := 19200;
      FORMAT                : natural                         := 0;
      BROADCAST             : natural                         := 1;
      GAP_COUNT_ONLY        : natural                         := 0;
      STRICT_TURNAROUND     : natural                         := 0;
      DROP_LATE             : natural                         := 0;
      RESPONSE_DELAY        : natural                         := 0;
      STALL_LIMIT           : natural                         := 0;
      DE_LEAD               : natural                         := 1;
      DE_TAIL               : natural                         := 0;
      ASCII                 : natural                         := 0;
      ASCII_DATA_BITS       : natural                         := 7;
      ASCII_EXTRA           : natural                         := 0;
      COIL_BASE             : natural                         := 0;
      COIL_COUNT            : natural                         := 64;
      DISCRETE_BASE         : natural                         := 0;
      DISCRETE_COUNT        : natural                         := 64;
      INPUT_BASE            : natural                         := 0;
      INPUT_COUNT           : natural                         := 64;
      HOLDING_BASE          : natural                         := 0;
      HOLDING_COUNT         : natural                         := 64;
      READ_ONLY_BASE        : natural                         := 0;
      READ_ONLY_COUNT       : natural                         := 0;
      FILE_COUNT            : natural                         := 0;
      FILE_RECORDS          : natural                         := 256;
      OVERLAY               : natural                         := 0;
      CLK_HZ                : natural                         := 50000000;
      T15_MIN_US            : natural                         := 750;
      T35_MIN_US            : natural                         := 1750;
      MAX_BIT_TIME          : natural                         := 65535;
      BIT_FRACTIONS         : natural                         := 0;
      GLITCH_FILTER         : natural                         := 0;
      UNIT_SET              : std_logic_vector(247 downto 0)  := (others => '0');
      UNIT_PORT             : natural                         := 0;
      ASCII_MODE            : natural                         := 0;
      ASCII_TIMEOUT_MS      : natural                         := 1000;
      FUNCTION_CODES        : mb_codes                        := x"00000000000000000000080001F399FE";
      USER_CODES            : mb_codes                        := x"00000000000000000000000000000000";
      MAX_READ_BITS         : natural                         := 2000;
      MAX_WRITE_BITS        : natural                         := 1968;
      MAX_READ_REGISTERS    : natural                         := 125;
      MAX_WRITE_REGISTERS   : natural                         := 123;
      RW_MAX_READ           : natural                         := 125;
      RW_MAX_WRITE          : natural                         := 121;
      BITS_PER_BEAT         : natural                         := 1;
      CHECK_WRITES          : natural                         := 0;
      SERVER_ID             : std_logic_vector(127 downto 0)  := x"00000000000000000000000000000009";
      SERVER_ID_BYTES       : natural                         := 1;
      ADDITIONAL_DATA       : std_logic_vector(1999 downto 0) := (others => '0');
      ADDITIONAL_DATA_BYTES : natural                         := 0;
      VENDOR_NAME           : string                          := "VENDOR";
      PRODUCT_CODE          : string                          := "PRODUCT";
      REVISION              : string                          := "V1.0";
      VENDOR_URL            : string                          := "";
      PRODUCT_NAME          : string                          := "";
      MODEL_NAME            : string                          := "";
      USER_APPLICATION_NAME : string                          := "";
      PRIVATE_OBJECTS       : std_logic_vector(4095 downto 0) := (others => '0');
      CONFORMITY            : std_logic_vector(7 downto 0)    := x"81";
      DEVICE_ID_LIMIT       : natural                         := 253;
      ALIVE_TIMEOUT_MS      : natural                         := 0
    );
    port (
      clk_i         : in  std_logic;
      rst_i         : in  std_logic := '0';
      rxd_i         : in  std_logic;
      txd_o         : out std_logic;
      de_o          : out std_logic;
      host_cyc_i    : in  std_logic := '0';
      host_stb_i    : in  std_logic := '0';
      host_we_i     : in  std_logic := '0';
      host_adr_i    : in  std_logic_vector(18 downto 0) := (others => '0');
      host_dat_i    : in  std_logic_vector(15 downto 0) := (others => '0');
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
  end component modbus_rtu_slave;

  component modbus_rtu_core is
    generic (
      CLK_HZ                : natural                         := 50000000;
      T15_MIN_US            : natural                         := 750;
      T35_MIN_US            : natural                         := 1750;
      MAX_BIT_TIME          : natural                         := 65535;
      BIT_FRACTIONS         : natural                         := 0;
      GLITCH_FILTER         : natural                         := 0;
      UNIT_SET              : std_logic_vector(247 downto 0)  := (others => '0');
      UNIT_PORT             : natural                         := 0;
      ASCII_MODE            : natural                         := 0;
      ASCII_TIMEOUT_MS      : natural                         := 1000;
      FUNCTION_CODES        : mb_codes                        := x"00000000000000000000080001F399FE";
      USER_CODES            : mb_codes                        := x"00000000000000000000000000000000";
      MAX_READ_BITS         : natural                         := 2000;
      MAX_WRITE_BITS        : natural                         := 1968;
      MAX_READ_REGISTERS    : natural                         := 125;
      MAX_WRITE_REGISTERS   : natural                         := 123;
      RW_MAX_READ           : natural                         := 125;
      RW_MAX_WRITE          : natural                         := 121;
      BITS_PER_BEAT         : natural                         := 1;
      CHECK_WRITES          : natural                         := 0;
      SERVER_ID             : std_logic_vector(127 downto 0)  := x"00000000000000000000000000000009";
      SERVER_ID_BYTES       : natural                         := 1;
      ADDITIONAL_DATA       : std_logic_vector(1999 downto 0) := (others => '0');
      ADDITIONAL_DATA_BYTES : natural                         := 0;
      VENDOR_NAME           : string                          := "VENDOR";
      PRODUCT_CODE          : string                          := "PRODUCT";
      REVISION              : string                          := "V1.0";
      VENDOR_URL            : string                          := "";
      PRODUCT_NAME          : string                          := "";
      MODEL_NAME            : string                          := "";
      USER_APPLICATION_NAME : string                          := "";
      PRIVATE_OBJECTS       : std_logic_vector(4095 downto 0) := (others => '0');
      CONFORMITY            : std_logic_vector(7 downto 0)    := x"81";
      DEVICE_ID_LIMIT       : natural                         := 253;
      ALIVE_TIMEOUT_MS      : natural                         := 0
    );
    port (
      clk_i         : in  std_logic;
      rst_i         : in  std_logic := '0';
      rxd_i         : in  std_logic;
      txd_o         : out std_logic;
      de_o          : out std_logic;
      settings_i    : in  mb_settings_vector;
      events_o      : out mb_events_vector;
      rx_active_o   : out std_logic;
      alive_o       : out std_logic;
      idle_o        : out std_logic;
      unit_o        : out std_logic_vector(7 downto 0);
      host_state_i  : in  mb_host_state_vector := MB_HOST_AT_REST;
      grant_req_o   : out std_logic;
      grant_space_o : out std_logic_vector(2 downto 0);
      grant_first_o : out std_logic_vector(15 downto 0);
      grant_last_o  : out std_logic_vector(15 downto 0);
      grant_write_o : out std_logic;
      grant_file_o  : out std_logic_vector(15 downto 0);
      grant_ack_i   : in  std_logic;
      exception_i   : in  std_logic_vector(3 downto 0);
      wb_cyc_o      : out std_logic;
      wb_stb_o      : out std_logic;
      wb_we_o       : out std_logic;
      wb_adr_o      : out std_logic_vector(18 downto 0);
      wb_dat_o      : out std_logic_vector(15 downto 0);
      wb_dat_i      : in  std_logic_vector(15 downto 0);
      wb_ack_i      : in  std_logic;
      wb_err_i      : in  std_logic := '0';
      user_req_o    : out std_logic;
      user_count_o  : out std_logic_vector(7 downto 0);
      user_adr_i    : in  std_logic_vector(7 downto 0) := (others => '0');
      user_dat_o    : out std_logic_vector(7 downto 0);
      user_reply_i  : in  mb_user_reply_vector := MB_NO_USER;
      status_stb_i  : in  std_logic := '0';
      status_adr_i  : in  std_logic_vector(6 downto 0) := (others => '0');
      status_dat_o  : out std_logic_vector(15 downto 0);
      status_ack_o  : out std_logic;
      write_stb_o   : out std_logic;
      listen_only_o : out std_logic
    );
  end component modbus_rtu_core;

  component modbus_bank_ram is
    generic (
      BITS_PER_BEAT   : natural := 1;
      CHECK_WRITES    : natural := 0;
      COIL_BASE       : natural := 0;
      COIL_COUNT      : natural := 64;
      DISCRETE_BASE   : natural := 0;
      DISCRETE_COUNT  : natural := 64;
      INPUT_BASE      : natural := 0;
      INPUT_COUNT     : natural := 64;
      HOLDING_BASE    : natural := 0;
      HOLDING_COUNT   : natural := 64;
      READ_ONLY_BASE  : natural := 0;
      READ_ONLY_COUNT : natural := 0;
      FILE_COUNT      : natural := 0;
      FILE_RECORDS    : natural := 256;
      OVERLAY         : natural := 0
    );
    port (
      clk_i         : in  std_logic;
      rst_i         : in  std_logic := '0';
      write_lock_i  : in  std_logic := '0';
      grant_req_i   : in  std_logic;
      grant_space_i : in  std_logic_vector(2 downto 0);
      grant_first_i : in  std_logic_vector(15 downto 0);
      grant_last_i  : in  std_logic_vector(15 downto 0);
      grant_write_i : in  std_logic;
      grant_file_i  : in  std_logic_vector(15 downto 0);
      grant_ack_o   : out std_logic;
      exception_o   : out std_logic_vector(3 downto 0);
      wb_cyc_i      : in  std_logic;
      wb_stb_i      : in  std_logic;
      wb_we_i       : in  std_logic;
      wb_adr_i      : in  std_logic_vector(18 downto 0);
      wb_dat_i      : in  std_logic_vector(15 downto 0);
      wb_dat_o      : out std_logic_vector(15 downto 0);
      wb_ack_o      : out std_logic;
      wb_err_o      : out std_logic;
      host_cyc_i    : in  std_logic := '0';
      host_stb_i    : in  std_logic := '0';
      host_we_i     : in  std_logic := '0';
      host_adr_i    : in  std_logic_vector(18 downto 0) := (others => '0');
      host_dat_i    : in  std_logic_vector(15 downto 0) := (others => '0');
      host_dat_o    : out std_logic_vector(15 downto 0);
      host_ack_o    : out std_logic;
      host_err_o    : out std_logic
    );
  end component modbus_bank_ram;

  component modbus_bank_io is
    generic (
      BITS_PER_BEAT   : natural := 1;
      READ_BACK_RAM   : natural := 0;
      COIL_BASE       : natural := 0;
      COIL_COUNT      : natural := 16;
      DISCRETE_BASE   : natural := 0;
      DISCRETE_COUNT  : natural := 16;
      INPUT_BASE      : natural := 0;
      INPUT_COUNT     : natural := 8;
      HOLDING_BASE    : natural := 0;
      HOLDING_COUNT   : natural := 8;
      READ_ONLY_BASE  : natural := 0;
      READ_ONLY_COUNT : natural := 0;
      FILE_COUNT      : natural := 0;
      FILE_RECORDS    : natural := 256;
      OVERLAY         : natural := 0
    );
    port (
      clk_i         : in  std_logic;
      rst_i         : in  std_logic := '0';
      write_lock_i  : in  std_logic := '0';
      grant_req_i   : in  std_logic;
      grant_space_i : in  std_logic_vector(2 downto 0);
      grant_first_i : in  std_logic_vector(15 downto 0);
      grant_last_i  : in  std_logic_vector(15 downto 0);
      grant_write_i : in  std_logic;
      grant_file_i  : in  std_logic_vector(15 downto 0);
      grant_ack_o   : out std_logic;
      exception_o   : out std_logic_vector(3 downto 0);
      wb_cyc_i      : in  std_logic;
      wb_stb_i      : in  std_logic;
      wb_we_i       : in  std_logic;
      wb_adr_i      : in  std_logic_vector(18 downto 0);
      wb_dat_i      : in  std_logic_vector(15 downto 0);
      wb_dat_o      : out std_logic_vector(15 downto 0);
      wb_ack_o      : out std_logic;
      wb_err_o      : out std_logic;
      coils_o       : out std_logic_vector(COIL_COUNT + boolean'pos(COIL_COUNT = 0) - 1 downto 0);
      discretes_i   : in  std_logic_vector(DISCRETE_COUNT + boolean'pos(DISCRETE_COUNT = 0) - 1 downto 0)
        := (others => '0');
      inputs_i      : in  std_logic_vector(16 * (INPUT_COUNT + boolean'pos(INPUT_COUNT = 0)) - 1 downto 0)
        := (others => '0');
      holdings_o    : out std_logic_vector(16 * (HOLDING_COUNT + boolean'pos(HOLDING_COUNT = 0)) - 1 downto 0)
    );
  end component modbus_bank_io;

  component modbus_auto_line is
    generic (
      CLK_HZ        : natural                        := 50000000;
      MIN_BAUD      : natural                        := 1200;
      RATES         : std_logic_vector(287 downto 0) := x"000384000001C2000000E1000000960000004B0000002580000012C000000960000004B0";
      RUN_BITS      : natural                        := 8;
      BAD_FRAMES    : natural                        := 1;
      GLITCH_FILTER : natural                        := 0
    );
    port (
      clk_i       : in  std_logic;
      rst_i       : in  std_logic := '0';
      rxd_i       : in  std_logic;
      rxd_o       : out std_logic;
      de_i        : in  std_logic := '0';
      idle_i      : in  std_logic := '0';
      frame_stb_i : in  std_logic := '0';
      bit_time_o  : out std_logic_vector(15 downto 0);
      format_o    : out std_logic_vector(1 downto 0);
      snap_i      : in  std_logic := '0';
      address_i   : in  std_logic_vector(7 downto 0) := (others => '0');
      mask_i      : in  std_logic_vector(7 downto 0) := (others => '0');
      locked_o    : out std_logic
    );
  end component modbus_auto_line;

  component modbus_line_health is
    generic (
      MAX_BIT_TIME : natural := 65535
    );
    port (
      clk_i       : in  std_logic;
      rst_i       : in  std_logic := '0';
      clear_i     : in  std_logic := '0';
      rxd_i       : in  std_logic;
      de_i        : in  std_logic := '0';
      rx_active_i : in  std_logic := '0';
      events_i    : in  std_logic_vector(7 downto 0) := (others => '0');
      settings_i  : in  mb_settings_vector;
      stb_i       : in  std_logic := '0';
      adr_i       : in  std_logic_vector(2 downto 0) := (others => '0');
      dat_o       : out std_logic_vector(15 downto 0);
      ack_o       : out std_logic
    );
  end component modbus_line_health;

end package modbus_pkg;

library ieee;
use ieee.numeric_std.all;

package body modbus_pkg is

  function mb_settings (
    address        : std_logic_vector(7 downto 0);
    bit_time       : std_logic_vector(15 downto 0);
    format         : std_logic_vector(1 downto 0)  := "00";
    broadcast      : std_logic                     := '1';
    gap_count_only : std_logic                     := '0';
    strict         : std_logic                     := '0';
    drop_late      : std_logic                     := '0';
    response_delay : std_logic_vector(11 downto 0) := x"000";
    stall_limit    : std_logic_vector(15 downto 0) := x"0000";
    de_lead        : std_logic_vector(3 downto 0)  := x"1";
    de_tail        : std_logic_vector(3 downto 0)  := x"0";
    bit_fraction   : std_logic_vector(3 downto 0)  := x"0";
    ascii          : std_logic                     := '0';
    eight_bits     : std_logic                     := '0';
    ascii_extra    : std_logic_vector(1 downto 0)  := "00"
  ) return mb_settings_vector is
  begin
    return ascii_extra & eight_bits & ascii & bit_fraction & de_tail & de_lead & stall_limit & response_delay & drop_late & strict & gap_count_only & broadcast
      & format & bit_time & address;
  end function;

  function mb_host_state (
    busy             : std_logic                     := '0';
    run              : std_logic                     := '1';
    failure          : std_logic_vector(3 downto 0)  := x"0";
    exception_status : std_logic_vector(7 downto 0)  := x"00";
    diagnostic       : std_logic_vector(14 downto 0) := "000000000000000";
    unit_ours        : std_logic                     := '0'
  ) return mb_host_state_vector is
  begin
    return unit_ours & diagnostic & exception_status & failure & run & busy;
  end function;

  function mb_user_reply (
    put       : std_logic;
    done      : std_logic;
    pass      : std_logic                    := '0';
    exception : std_logic_vector(3 downto 0) := x"0";
    data      : std_logic_vector(7 downto 0)
  ) return mb_user_reply_vector is
  begin
    return data & exception & pass & done & put;
  end function;

  function mb_bit (code : natural) return mb_codes is
    variable codes : mb_codes := (others => '0');
  begin
    codes(code) := '1';
    return codes;
  end function;

  function mb_bit_time (clk_hz : positive; baud : positive) return std_logic_vector is
  begin
    return std_logic_vector(to_unsigned((clk_hz + baud / 2) / baud, 16));
  end function;

  function mb_text (text : string; bytes : positive) return std_logic_vector is
    variable made  : std_logic_vector(8 * bytes - 1 downto 0) := (others => '0');
    variable place : natural;
  begin
    for k in text'range loop
      place := 8 * (text'right - k);
      made(place + 7 downto place) := std_logic_vector(to_unsigned(character'pos(text(k)), 8));
    end loop;
    return made;
  end function;

end package body modbus_pkg;
