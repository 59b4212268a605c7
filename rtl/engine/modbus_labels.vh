// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// modbus_labels - the labels of the listing, each once; part of modbus_program.  A place in the listing that is jumped
// to or run into has a label: a routine, a table, or a line inside a routine.

// modbus_routines_tables
`NAME(SUB_TABLE) `NAME(FUNCTION_TABLE)

// modbus_routines_frame
`NAME(START) `NAME(BUILT_IN) `NAME(BAD) `NAME(FOREIGN) `NAME(LISTENING) `NAME(RESTART) `NAME(CLEARING)

// modbus_routines_data
`NAME(MASK_WRITE) `NAME(READ_FIFO) `NAME(WRITE_COIL) `NAME(WRITE_REGISTER) `NAME(WRITE_SINGLE)
`NAME(WRITE_COILS) `NAME(WRITE_REGISTERS) `NAME(WRITE_MULTIPLE) `NAME(WRITTEN) `NAME(ECHO) `NAME(READ_WRITE)
`NAME(READ_COILS) `NAME(READ_DISCRETES) `NAME(READ_BITS) `NAME(READ_INPUTS) `NAME(READ_HOLDINGS)
`NAME(READ_WORDS) `NAME(READ) `NAME(READ_ANSWER)

// modbus_routines_answer
`NAME(ANSWER) `NAME(ANSWER_HEAD) `NAME(SENDING) `NAME(TAIL) `NAME(TAIL_NO_EVENT) `NAME(FATE) `NAME(DONE)
`NAME(SEND_UPPER) `NAME(EXCEPTION)

// modbus_routines_diagnostics
`NAME(EXCEPTION_STATUS) `NAME(DIAGNOSTICS) `NAME(SUB_ECHO) `NAME(SUB_REGISTER) `NAME(SUB_COUNTER)
`NAME(SUB_DELIMITER) `NAME(SUB_LISTEN) `NAME(SUB_CLEAR) `NAME(SUB_OVERRUN) `NAME(SUB_RESTART)
`NAME(EVENT_COUNTER) `NAME(EVENT_LOG)

// modbus_routines_files
`NAME(READ_FILES) `NAME(WRITE_FILES)

// modbus_routines_identity
`NAME(REPORT_SERVER_ID) `NAME(DEVICE_ID) `NAME(FOUND)
