/* SPDX-License-Identifier: Apache-2.0
 * Copyright (c) 2026 the project contributors
 *
 * modbus_map - the tables as a CPU sees them behind modbus_axil_slave, and as modbus_axil_master sees the bus.
 *
 * One item is one 32-bit word: a register in bits 15..0, a coil or discrete input in bit 0, the rest 0.
 * MODBUS_BASE, the address of the window, is yours to define.  Items are zero based, as on the line.
 */
#ifndef MODBUS_MAP_H
#define MODBUS_MAP_H

#include <stdint.h>

#ifndef MODBUS_BASE
#error "define MODBUS_BASE, the byte address of the window, before this line"
#endif

#define MODBUS_WINDOW     0x200000u /* bytes */

#define MODBUS_COILS      0x000000u /* byte offsets in the window */
#define MODBUS_DISCRETES  0x040000u
#define MODBUS_INPUTS     0x080000u
#define MODBUS_HOLDINGS   0x0C0000u
#define MODBUS_FILES      0x100000u
#define MODBUS_CORE       0x140000u /* counters, event log, settings: the items are in rtl/bank/modbus_host_map.v */
#define MODBUS_HOLD       0x1C0000u /* 1: the memory stays the CPU's between accesses; modbus_axil_slave alone has it */

#define MODBUS_COIL(n)     MODBUS_WORD_(MODBUS_COILS, n)
#define MODBUS_DISCRETE(n) MODBUS_WORD_(MODBUS_DISCRETES, n)
#define MODBUS_INPUT(n)    MODBUS_WORD_(MODBUS_INPUTS, n)
#define MODBUS_HOLDING(n)  MODBUS_WORD_(MODBUS_HOLDINGS, n)
#define MODBUS_RECORD(file, n, records) MODBUS_WORD_(MODBUS_FILES, ((file) - 1u) * (records) + (n)) /* records: FILE_RECORDS */

#define MODBUS_STATUS(n)   MODBUS_WORD_(MODBUS_CORE, n) /* 0x00 diagnostic register, 0x0A..0x12 counters, 0x40 + n log */
#define MODBUS_ADDRESS     MODBUS_WORD_(MODBUS_CORE, 0x80u)
#define MODBUS_BIT_TIME    MODBUS_WORD_(MODBUS_CORE, 0x81u)
#define MODBUS_BIT_FRACTION MODBUS_WORD_(MODBUS_CORE, 0x87u) /* with BIT_FRACTIONS = 1; set it with MODBUS_BIT_TIME */
#define MODBUS_FORMAT      MODBUS_WORD_(MODBUS_CORE, 0x82u)
#define MODBUS_EXCEPTION_STATUS MODBUS_WORD_(MODBUS_CORE, 0x89u)
#define MODBUS_IDLE        MODBUS_WORD_(MODBUS_CORE, 0x8Cu) /* 1: the line is idle, rate and format may change */

#define MODBUS_WORD_(table, n) (*(volatile uint32_t *)((uintptr_t)(MODBUS_BASE) + (table) + 4u * (n)))

/* A 32-bit value in two registers, high word first, in one piece for the line.
 * HOLD is one bit for everybody: where an interrupt uses it too, keep interrupts out meanwhile. */
static inline uint32_t modbus_read32(uint32_t table, uint32_t n)
{
    uint32_t value;

    MODBUS_WORD_(MODBUS_HOLD, 0) = 1u;
    value = MODBUS_WORD_(table, n) << 16;
    value |= MODBUS_WORD_(table, n + 1u);
    MODBUS_WORD_(MODBUS_HOLD, 0) = 0u;
    return value;
}

static inline void modbus_write32(uint32_t table, uint32_t n, uint32_t value)
{
    MODBUS_WORD_(MODBUS_HOLD, 0) = 1u;
    MODBUS_WORD_(table, n) = value >> 16;
    MODBUS_WORD_(table, n + 1u) = value & 0xFFFFu;
    MODBUS_WORD_(MODBUS_HOLD, 0) = 0u;
}

#endif
