# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Which names a map may use: identifiers of Verilog, VHDL, C and Python at once."""

from __future__ import annotations

import keyword
import re

IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*")  # VHDL allows no other underscores
LONGEST = 48

VERILOG = frozenset(
    """
    always and assign automatic begin buf bufif0 bufif1 case casex casez cell cmos config deassign default defparam
    design disable edge else end endcase endconfig endfunction endgenerate endmodule endprimitive endspecify endtable
    endtask event for force forever fork function generate genvar highz0 highz1 if ifnone incdir include initial inout
    input instance integer join large liblist library localparam macromodule medium module nand negedge nmos nor
    noshowcancelled not notif0 notif1 or output parameter pmos posedge primitive pull0 pull1 pulldown pullup
    pulsestyle_onevent pulsestyle_ondetect rcmos real realtime reg release repeat rnmos rpmos rtran rtranif0 rtranif1
    scalared showcancelled signed small specify specparam strong0 strong1 supply0 supply1 table task time tran tranif0
    tranif1 tri tri0 tri1 triand trior trireg unsigned use uwire vectored wait wand weak0 weak1 while wire wor xnor xor
    """.split()
)
SYSTEMVERILOG = frozenset(
    """
    accept_on alias always_comb always_ff always_latch assert assume before bind bins binsof bit break byte chandle
    checker class clocking const constraint context continue cover covergroup coverpoint cross dist do endchecker
    endclass endclocking endgroup endinterface endpackage endprogram endproperty endsequence enum eventually expect
    export extends extern final first_match foreach forkjoin global iff ignore_bins illegal_bins implements implies
    import inside int interconnect interface intersect join_any join_none let local logic longint matches modport
    nettype new nexttime null package packed priority program property protected pure rand randc randcase randsequence
    ref reject_on restrict return s_always s_eventually s_nexttime s_until s_until_with sequence shortint shortreal
    soft solve static string strong struct super sync_accept_on sync_reject_on tagged this throughout timeprecision
    timeunit type typedef union unique unique0 until until_with untyped var virtual void wait_order weak wildcard with
    within
    """.split()
)
VHDL = frozenset(
    """
    abs access after alias all and architecture array assert attribute begin block body buffer bus case component
    configuration constant disconnect downto else elsif end entity exit file for function generate generic group guarded
    if impure in inertial inout is label library linkage literal loop map mod nand new next nor not null of on open or
    others out package port postponed procedure process protected pure range record register reject rem report return
    rol ror select severity shared signal sla sll sra srl subtype then to transport type unaffected units until use
    variable wait when while with xnor xor
    """.split()
)
C = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long register
    restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    alignas alignof and and_eq asm bitand bitor bool catch class compl const_cast constexpr decltype delete
    dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr operator or or_eq
    private protected public reinterpret_cast static_assert static_cast template this thread_local throw true try
    typeid typename using virtual wchar_t xor xor_eq
    """.split()
)
PYTHON = frozenset(keyword.kwlist)

# Attributes that the Python client has beside the points.
CLIENT = frozenset({"client", "close", "connect", "device_id", "points", "read", "write", "read_all", "freeze"})

LANGUAGES = (
    ("Verilog", VERILOG, False),
    ("SystemVerilog", SYSTEMVERILOG, False),
    ("VHDL", VHDL, True),
    ("C", C, False),
    ("Python", PYTHON, False),
)


def keyword_of(name: str) -> str:
    """The language whose keyword a name is, or nothing. VHDL knows no case."""
    for language, words, any_case in LANGUAGES:
        if name in words or (any_case and name.lower() in words):
            return language
    return ""


def identifier_of(label: str) -> str:
    """An identifier in capitals of any text: OVER_VOLTAGE of "over-voltage"; an empty text gives one too."""
    made = re.sub(r"[^A-Za-z0-9]+", "_", label).strip("_").upper()
    if not made:
        return "VALUE"
    return f"V{made}" if made[0].isdigit() else made
