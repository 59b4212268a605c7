# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The text of NAME_bank: the tables of a map behind the core's grant question and Wishbone port."""

from __future__ import annotations

from collections.abc import Callable

from modbus_map.model import SPACES, Device, Point
from modbus_map.rtl_plan import COMPARED_ENUM, FILES_SPACE, Area, Item, Plan, Row, runs
from modbus_map.rtl_text import aligned, bits, fill, literal, slice_of

SPACE_NAMES = ("`MB_SPACE_COILS", "`MB_SPACE_DISCRETES", "`MB_SPACE_INPUTS", "`MB_SPACE_HOLDINGS", "`MB_SPACE_FILES")
KEYS = ("coil", "discrete", "in_word", "holding")  # wires that hold the keys
TABLE_WORDS = ("coil", "discrete input", "input register", "holding register", "record")
UNSIGNED, SIGNED, FLOAT = range(3)
LOOP_FROM = 3  # items of an array that are written by a loop

# Names, and ends of names, that the bank needs for itself; a point of such a name gets another one inside the bank.
OWN = frozenset(
    "clk rst grant_req grant_space grant_first grant_last grant_write grant_file grant_ack exception wb_cyc wb_stb wb_we "
    "wb_adr wb_dat wb_ack wb_err host_cyc host_stb host_we host_adr host_dat host_ack host_err row asked ack refused grant_refused host_ready "
    "ready look held begun kind from stage bit memory host refuse back from_back unused".split()
)

OWN_ENDS = ("_frozen", "_stb", "_written")


def signal(point: Point) -> str:
    """The name of a point inside the bank."""
    return f"{point.name}_point" if point.name in OWN or point.name.endswith(OWN_ENDS) else point.name


def port(point: Point, suffix: str) -> str:
    """The name of a port of the bank."""
    return f"{signal(point)}_{suffix}"


def source(point: Point) -> str:
    """What the value of a point is read from; nothing for a constant."""
    if point.kind == "register":
        return f"{signal(point)}_q"
    return f"{signal(point)}_frozen_q" if point.freeze else f"{signal(point)}_i"


def whole_reset(point: Point) -> int:
    """The reset values of all items as one number, item 0 lowest."""
    return sum(raw << (n * point.bits) for n, raw in enumerate(point.resets))


class Bank:
    """Writes the module, section by section."""

    def __init__(self, device: Device) -> None:
        self.device, self.plan = device, Plan(device)

    def text(self) -> str:
        sections = [
            self.head(),
            self.grant(),
            self.beats(),
            self.memory(),
            self.keys(),
            self.reading(),
            self.writing(),
            self.read_back(),
            self.checking(),
            self.registers(),
            self.snapshots(),
            self.answers(),
        ]
        return "\n".join("\n".join(section) + "\n" for section in sections if section) + "\nendmodule\n"

    # ---------------------------------------------------------------- head

    def head(self) -> list[str]:
        ports = [line for p in self.device.points for line in self.ports(p)]
        if self.plan.areas:
            ports += [
                ("input  wire", "", "host_cyc_i", "hold it over accesses that belong together"),
                ("input  wire", "", "host_stb_i", "hold it until host_ack_o or host_err_o"),
                ("input  wire", "", "host_we_i", ""),
                ("input  wire", "[18:0]", "host_adr_i", "{space, item}"),
                ("input  wire", "[15:0]", "host_dat_i", ""),
                ("output wire", "[15:0]", "host_dat_o", "valid with host_ack_o"),
                ("output wire", "", "host_ack_o", ""),
                ("output wire", "", "host_err_o", "instead of it: no such item"),
            ]
        name = self.device.name
        lines = [f"module {name}_bank (", "  input  wire        clk_i,", "  input  wire        rst_i,", ""]
        lines += ["  // Core: grant and Wishbone", '`include "modbus_bank_ports.vh"']
        if ports:
            lines += ["  ,", "", "  // Points", *port_lines(ports)]
        lines += [");", ""]
        return [*lines, *self.declarations()]

    def declarations(self) -> list[str]:
        """The registers of the points."""
        lines = []
        for point in self.device.points:
            name, size = signal(point), point.bits * point.count
            kept = [f"{name}_q"] if point.kind == "register" else [f"{name}_frozen_q"] if point.freeze else []
            for register in kept:
                lines.append(f"  reg  {bits(size):<6} {register} = {literal(size, whole_reset(point))};")
            if self.in_ram(point):
                lines.append(f"  reg  {bits(point.size):<6} {name}_written_q = {literal(point.size, 0)};")
            if point.strobe:
                lines.append(f"  reg  {bits(point.count):<6} {name}_stb_q = {literal(point.count, 0)};")
        return ["  // What the points hold", *lines, ""] if lines else []

    def in_ram(self, point: Point) -> bool:
        """True if the registers of a point are read back from the RAM."""
        return self.plan.in_ram(Item(point, 0))

    def ports(self, point: Point) -> list[tuple[str, str, str, str]]:
        """(direction, range, name, comment) of the ports of a point."""
        span, found = bits(point.bits * point.count), []
        if point.kind == "register":
            found.append(("output wire", span, port(point, "o"), place_of(point)))
        elif point.kind == "wire":
            found.append(("input  wire", span, port(point, "i"), place_of(point)))
        if point.strobe:
            found.append(("output wire", bits(point.count), port(point, "stb_o"), "strobe: the master has written it"))
        return found

    # ---------------------------------------------------------------- grant

    def grant(self) -> list[str]:
        """The answer to the core's question: from one row, or from the rows of a table one after the other."""
        table = self.plan.table_of_rows
        files = any(space == FILES_SPACE for _, _, space in table)
        more = any(more for _, more, _ in table)
        # Rows that begin at 0 and hold a power of two need no comparison: the address bits above must be 0.
        round_ = all(row.low == 0 and row.high & (row.high + 1) == 0 for row, _, _ in table)
        fields = ["more"] * more + ["file"] * files + (["exists", "high"] if round_ else ["low", "high"])

        def said(row: Row | None, again: bool = False) -> str:
            values = [f"1'b{int(again)}"] * more + [f"16'd{row.file if row else 0}"] * files
            values += [f"1'b{int(row is not None)}"] if round_ else [f"16'd{row.low}" if row else "16'hFFFF"]
            return f"{{{', '.join(fields)}}} = {{{', '.join([*values, f'16{chr(39)}d{row.high if row else 0}'])}}};"

        lines = banner("May this range be accessed?")
        lines += ["  // A row is a run of addresses that may be read, or written.  A request is granted if a row holds all of it."]
        if round_:
            lines += ["  reg  [15:0] high;                  // last address of the row; the first is 0"]
            lines += ["  reg         exists;                // there is a row"]
        else:
            lines += ["  reg  [15:0] low, high;             // first and last address of the row"]
        lines += ["  reg  [15:0] file;                  // its file"] if files else []
        lines += self.rows(said) if more else self.only_row(said)
        fits = "exists & ((grant_last_i & ~high) == 16'd0)" if round_ else "(grant_first_i >= low) & (grant_last_i <= high)"
        if files:
            fits += f" & (grant_space_i != {SPACE_NAMES[4]} | grant_file_i == file)"
        lines += ["  reg  asked_q = 1'b0;               // row_q is a row of the question"] if more else []
        lines += ["  reg  grant_ack_q = 1'b0, grant_refused_q = 1'b0;", f"  wire fits  = {fits};"]
        lines += ["  wire ends  = asked_q & (fits | ~more);"] if more else []
        lines += ["", "  always @(posedge clk_i) begin"]
        if more:
            lines += ["    asked_q         <= grant_req_i & ~ends & ~grant_ack_q & ~rst_i;"]
            lines += [f"    row_q           <= asked_q ? row_q + {literal(self.row_width, 1)} : first_row;"]
        ends = "ends" if more else "~grant_ack_q"
        return [
            *lines,
            f"    grant_ack_q     <= grant_req_i & {ends} & ~rst_i;",
            "    grant_refused_q <= ~fits;",
            "  end",
        ]

    @property
    def row_width(self) -> int:
        return max(1, len(self.plan.table_of_rows).bit_length())

    def only_row(self, said: Callable[..., str]) -> list[str]:
        """No question has several rows: it is answered in one clock."""
        plan = self.plan
        asked: dict[tuple[Row, int], list[str]] = {}
        for write, space in sorted(plan.questions):
            row = plan.table_of_rows[plan.first_row(write, space)][0]
            asked.setdefault((row, space), []).append(f"{{1'b{int(write)}, {SPACE_NAMES[space]}}}")
        lines = ["", "  always @*", "    case ({grant_write_i, grant_space_i})"]
        lines += [f"      {', '.join(keys)}: {said(row)}  // {row_text(row, space)}" for (row, space), keys in asked.items()]
        return [*lines, f"      default: {said(None)}  // nothing", "    endcase", ""]

    def rows(self, said: Callable[..., str]) -> list[str]:
        """The rows of a table are tried one a clock."""
        plan, width, table = self.plan, self.row_width, self.plan.table_of_rows
        lines = [
            "  reg         more;                  // the next row is to be tried too",
            f"  reg  {bits(width):<6} row_q;               // where a table has several rows they are tried one a clock",
            f"  reg  {bits(width):<6} first_row;",
            "",
            "  always @* begin",
            "    case ({grant_write_i, grant_space_i})",
        ]
        for write, space in sorted(plan.questions):
            number = literal(width, plan.first_row(write, space))
            lines.append(f"      {{1'b{int(write)}, {SPACE_NAMES[space]}}}: first_row = {number};")
        lines += [f"      default: first_row = {literal(width, len(table))};", "    endcase", "    case (row_q)"]
        lines += [
            f"      {literal(width, number)}: {said(row, again)}  // {row_text(row, space)}"
            for number, (row, again, space) in enumerate(table)
        ]
        return [*lines, f"      default: {said(None)}  // nothing", "    endcase", "  end", ""]

    # ---------------------------------------------------------------- beats

    def beats(self) -> list[str]:
        plan = self.plan
        host = " & ~host_q" if plan.areas else ""
        lines = banner("Beats")
        lines += ["  wire [2:0]  space   = wb_adr_i[18:16];", "  wire [15:0] address = wb_adr_i[15:0];"]
        lines += ["  wire        words   = (space[2:1] != 2'b00);"] if plan.checks or plan.has(2) or plan.has(3) else []
        if plan.checks:
            lines += ["  wire        checks  = (space[2:1] == 2'b11);       // a checking pass: nothing is stored"]
        if plan.areas:
            lines += ["  reg         host_q = 1'b0;                         // the host has its turn"]
        lines += [f"  wire        beat    = wb_cyc_i & wb_stb_i{host};", "  reg         ready_q = 1'b0;"]
        if plan.checks:
            lines += ["  reg         look_q = 1'b0;                         // the value is being checked"]
        begins = "beat & ~ready_q" + (" & ~look_q" if plan.checks else "")
        lines += [f"  wire        begins  = {begins};", "  wire        done    = beat & ready_q;"]
        if self.writes:
            lines += [f"  wire        write   = done & wb_we_i{' & ~checks' if plan.checks else ''};"]
        lines += ["", "  always @(posedge clk_i) begin"]
        if plan.checks:
            lines += ["    look_q  <= begins & checks & ~rst_i;", "    ready_q <= ((begins & ~checks) | (beat & look_q)) & ~rst_i;"]
        else:
            lines += ["    ready_q <= begins & ~rst_i;"]
        return [*lines, "  end"]

    @property
    def writes(self) -> bool:
        plan = self.plan
        return plan.writes_coils or plan.writes_words or plan.writes_memory

    @property
    def tracks(self) -> bool:
        """True if a burst has a memory of what it has passed: some value has several words."""
        return self.plan.held_words > 1 or self.plan.staged_words > 1

    def keys(self) -> list[str]:
        plan = self.plan
        if not plan.keys:
            return []
        lines = banner("Which item")
        lines += ["  // The address was granted: a few of its bits tell the items of a table apart."]
        for space, chosen in plan.keys.items():
            parts = [f"address[{b}:{a}]" if b > a else f"address[{a}]" for a, b in reversed(runs(chosen))]
            what = parts[0] if len(parts) == 1 else "{" + ", ".join(parts) + "}"
            lines.append(f"  wire {bits(len(chosen)):<6} {KEYS[space]} = {what};")
        for space in plan.keys:
            if plan.has_free_addresses(space):
                terms = [term for low, high in plan.covered(space) for term in [between("address", low, high)]]
                lines.append(f"  wire        {KEYS[space]}_is = {' | '.join(terms)};   // something is at the address")
        if plan.held_words > 1:
            lines += self.word_number("part", "which word of the value", self.plan.held_words, whole=True)
        if plan.staged_words > 1:
            lines += self.word_number("word", "which word of a value that is written", plan.staged_words, whole=False)
            tails = self.not_last()
            lines += ["", "  // The last word of the value, or of the request: the value is stored."]
            lines += ["  reg         tail;", "  always @* begin", "    case (holding)"]
            lines += [f"      {line}" for line in fill(tails, ": tail = 1'b0;")]
            lines += ["      default: tail = 1'b1;", "    endcase", "  end"]
            lines += [f"  wire        closes  = tail{' | in_memory' if plan.areas else ''} | (address == grant_last_i);"]
        return lines

    def word_number(self, name: str, what: str, most: int, whole: bool) -> list[str]:
        """The number of a word in its item, 0 for items of one word."""
        plan, width = self.plan, (most - 1).bit_length()
        by_space: dict[int, dict[int, list[str]]] = {2: {}, 3: {}}
        for space in (2, 3) if whole else (3,):
            for item in plan.items(space):
                if item.point.width == 1 or (not plan.is_whole(item) if whole else not is_staged(item)):
                    continue
                for word, address in enumerate(item.addresses):
                    if word:
                        key = literal(plan.key_width(space), plan.key(space, address))
                        by_space[space].setdefault(word, []).append(key)
        lines = ["", f"  // {what[0].upper()}{what[1:]}", f"  reg  {bits(width):<6} {name};", "  always @* begin", f"    {name} = {literal(width, 0)};"]
        for space, numbers in by_space.items():
            if not numbers:
                continue
            condition = ("words & " if plan.keys.keys() & {0, 1} else "") + ("space[0]" if space == 3 else "~space[0]")
            condition += " & ~in_memory" if plan.areas else ""  # the keys of words in memory are those of other items
            lines += [f"    if ({condition})", f"      case ({KEYS[space]})"]
            for word, keys in sorted(numbers.items()):
                lines += [f"        {line}" for line in fill(keys, f": {name} = {literal(width, word)};")]
            lines += ["        default: ;", "      endcase"]
        return [*lines, "  end"]

    def not_last(self) -> list[str]:
        """The keys of words behind which words of the same value follow."""
        plan = self.plan
        return [
            literal(plan.key_width(3), plan.key(3, address))
            for item in plan.items(3)
            if is_staged(item)
            for address in item.addresses[:-1]
        ]

    # ---------------------------------------------------------------- reading

    def reading(self) -> list[str]:
        plan = self.plan
        if not plan.keys:
            return []
        width = 16 * plan.held_words
        lines = banner("Reading")
        for space, name in ((0, "coils"), (1, "discretes")):
            if plan.has(space):
                lines += self.bit_vector(space, name)
        if plan.held_words > 1:
            lines += ["  // A value of several words is loaded in one clock, when its first word is asked for; its first word on top."]
        lines += [f"  reg  {bits(width)} item;", "  always @* begin"]
        bit_rows, word_rows = [s for s in (0, 1) if plan.has(s)], [s for s in (2, 3) if plan.has(s)]
        pad = f", {width - 16}'d0" if width > 16 else ""

        def bit_line(space: int) -> str:
            known = f" & {KEYS[space]}_is" if plan.has_free_addresses(space) else ""
            return f"item = {{15'd0, {('coils', 'discretes')[space]}[{KEYS[space]}]{known}{pad}}};"

        if word_rows:
            body = []
            for n, space in enumerate(word_rows):
                if len(word_rows) == 2:
                    body.append("if (~space[0])" if n == 0 else "else")
                body += [("  " if len(word_rows) == 2 else "") + line for line in self.word_cases(space, width)]
            if bit_rows:
                lines += ["    if (words) begin", *("      " + line for line in body), "    end else begin"]
                lines += self.bit_choice(bit_rows, bit_line, "      ")
                lines += ["    end"]
            else:
                lines += ["    " + line for line in body]
        else:
            lines += self.bit_choice(bit_rows, bit_line, "    ")
        lines += ["  end", ""]
        lines += self.held(width)
        return lines

    @staticmethod
    def bit_choice(spaces: list[int], line, indent: str) -> list[str]:
        if len(spaces) == 1:
            return [indent + line(spaces[0])]
        return [f"{indent}if (space[0]) {line(1)}", f"{indent}else          {line(0)}"]

    def bit_vector(self, space: int, name: str) -> list[str]:
        """The table as one vector, each bit at the place of its key."""
        plan = self.plan
        places: dict[int, Item] = {plan.key(space, item.at): item for item in plan.items(space)}
        size, pieces, at = 1 << plan.key_width(space), [], 0
        while at < size:
            item = places.get(at)
            end = at + 1
            if item is None or not plan.read_back(item):
                while end < size and (places.get(end) is None or not plan.read_back(places[end])):
                    end += 1
                pieces.append(f"{end - at}'d0")
            else:
                point, first = item.point, item.index
                while end < size and (n := places.get(end)) and n.point is point and n.index == first + end - at:
                    end += 1
                if point.kind == "constant":
                    value = whole_reset(point) >> first & ((1 << (end - at)) - 1)
                    pieces.append(literal(end - at, value))
                else:
                    pieces.append(slice_of(source(point), point.count, first + end - at - 1, first))
            at = end
        what = pieces[0] if len(pieces) == 1 else "{" + ", ".join(reversed(pieces)) + "}"
        return [f"  wire {bits(size)} {name} = {what};"]

    def word_cases(self, space: int, width: int) -> list[str]:
        """The case that finds an item by its key."""
        plan = self.plan
        rows: list[tuple[list[str], str]] = []
        resets: dict[str, list[str]] = {}  # of the words that are in the RAM
        for item in plan.items(space):
            if not plan.read_back(item):
                continue
            keys = [literal(plan.key_width(space), plan.key(space, a)) for a in item.addresses]
            if plan.is_whole(item):
                rows.append((keys, self.item_value(item, range(item.point.width), width)))
            else:
                for word, key in enumerate(keys):
                    value = self.item_value(item, [word], width)
                    if plan.in_ram(item):
                        resets.setdefault(value, []).append(key)
                    else:
                        rows.append(([key], value))
        rows += [(keys, value) for value, keys in sorted(resets.items(), key=lambda found: len(found[1]))]
        lines = [f"case ({KEYS[space]})"]
        for n, (keys, value) in enumerate(rows):
            known = f"{KEYS[space]}_is ? {value} : {width}'d0" if plan.has_free_addresses(space) else value
            if n == len(rows) - 1:
                lines.append(f"  default: item = {known};")
            else:
                lines += [f"  {line}" for line in fill(keys, f": item = {known};")]
        if not rows:
            lines.append(f"  default: item = {width}'d0;")
        return [*lines, "endcase"]

    def item_value(self, item: Item, words, width: int) -> str:
        """Words of an item, the first on top, zeros below."""
        point, parts = item.point, []
        spans: list[list[int]] = []
        for word in words:
            high, low = item.word_bits(word)
            if spans and spans[-1][1] == high + 1:
                spans[-1][1] = low
            else:
                spans.append([high, low])
        for high, low in spans:
            if point.kind == "constant" or self.plan.in_ram(item):
                parts.append(literal(high - low + 1, whole_reset(point) >> low & ((1 << (high - low + 1)) - 1)))
            else:
                parts.append(slice_of(source(point), point.bits * point.count, high, low))
        if rest := width - 16 * len(list(words)):
            parts.append(f"{rest}'d0")
        return parts[0] if len(parts) == 1 else "{" + ", ".join(parts) + "}"

    def held(self, width: int) -> list[str]:
        """The register behind the bus, and what a burst remembers."""
        plan = self.plan
        lines = []
        if self.tracks:
            lines += [
                "  // begun: in this burst, the beat before this one was of the same kind.  The strobe of a beat comes with its kind.",
                "  reg         begun_q = 1'b0;",
                "  reg  [3:0]  kind_q;",
                "  wire [3:0]  kind  = {space, wb_we_i};",
                "  wire        begun = begun_q & (kind == kind_q);",
                "",
                "  always @(posedge clk_i) begin",
                "    if (done) kind_q <= kind;",
                "    begun_q <= (begun_q | done) & wb_cyc_i & ~grant_req_i & ~rst_i;",
                "  end",
                "",
            ]
        lines.append(f"  reg  {bits(width)} held_q;")
        load = "begins"
        if plan.held_words > 1:
            zero = literal((plan.held_words - 1).bit_length(), 0)
            load += f" & (~begun | part == {zero}{' | wb_we_i' if plan.checks else ''})"
        return [*lines, f"  always @(posedge clk_i) if ({load}) held_q <= item;"]

    def read_back(self) -> list[str]:
        """The RAM that has what the master has written, so that no multiplexer takes it from the registers."""
        plan = self.plan
        if not plan.reads_back:
            return []
        size, gaps = 1 << plan.key_width(3), " & holding_is" if plan.has_free_addresses(3) else ""
        memory = " & ~in_memory" if plan.areas else ""
        lines = [
            *banner("Read back"),
            "  // Registers that are written and read back: each write goes to a RAM too, and a read takes its word from there.",
            "  // A RAM keeps its words through rst_i, so until a register has been written held_q has its reset value.",
            f"  (* no_rw_check *) reg [15:0] back [0:{size - 1}];",
            "  reg  [15:0] back_q;",
            "  reg         from_back_q;",
            "  reg         written;",
            "",
            "  always @* begin",
            "    case (holding)",
        ]
        for item in plan.items(3):
            if plan.in_ram(item):
                for word, address in enumerate(item.addresses):
                    flag = self.written(item, word)
                    lines.append(f"      {literal(plan.key_width(3), plan.key(3, address))}: written = {flag};")
        return [
            *lines,
            "      default: written = 1'b0;",
            "    endcase",
            "  end",
            "",
            "  always @(posedge clk_i) begin",
            "    if (write_holding) back[holding] <= wb_dat_i;",
            "    back_q <= back[holding];",
            f"    from_back_q <= written & (space == {SPACE_NAMES[3]}){gaps}{memory};",
            "  end",
        ]

    @staticmethod
    def written(item: Item, word: int) -> str:
        """The flag of a word: it has been written since the reset."""
        number = item.index * item.point.width + word
        return slice_of(f"{signal(item.point)}_written_q", item.point.size, number, number)

    # ---------------------------------------------------------------- writing

    def writing(self) -> list[str]:
        plan = self.plan
        if not plan.writes_words and not plan.writes_coils:
            return []
        lines = banner("Writing")
        memory = " & ~in_memory" if plan.areas else ""
        if plan.writes_coils:
            known = " & coil_is" if plan.has_free_addresses(0) else ""
            lines.append(f"  wire        write_coil    = write & (space == {SPACE_NAMES[0]}){known};")
        if plan.writes_words:
            known = (" & holding_is" if plan.has_free_addresses(3) else "") + memory
            lines.append(f"  wire        write_holding = write & (space == {SPACE_NAMES[3]}){known};")
        if plan.staged_words == 1:
            return lines
        count, width = plan.staged_words, (plan.staged_words - 1).bit_length()
        lines += [
            "",
            "  // The words of a value wait here for its last one; then all of them are stored in one clock.  from is the first",
            "  // word of the value that the request covers: a value keeps those that it does not.",
            f"  reg  {bits(16 * (count - 1))} stage_q;                      // word 0 lowest",
            f"  reg  {bits(width):<6} from_q;",
            f"  wire {bits(width):<6} from = (~begun | word == {literal(width, 0)}) ? word : from_q;",
            "",
            "  always @(posedge clk_i)",
            "    if (done & wb_we_i) begin",
            "      from_q <= from;",
        ]
        for k in range(count - 1):
            guard = f"if (word == {literal(width, k)}) " if count > 2 else "if (~word) " if width == 1 else ""
            lines.append(f"      {guard}stage_q[{16 * k + 15}:{16 * k}] <= wb_dat_i;")
        lines += ["    end", ""]
        for k in range(count - 1):
            lines.append(
                f"  wire [15:0] word_{k} = (word == {literal(width, k)}) ? wb_dat_i : stage_q[{16 * k + 15}:{16 * k}];"
            )
        lines.append(f"  wire [15:0] word_{count - 1} = wb_dat_i;")
        lines += [f"  wire {bits(count):<6} covered;"]
        for k in range(count):
            terms = []
            if k:
                terms.append(f"(word >= {literal(width, k)})" if k < (1 << width) - 1 else f"(word == {literal(width, k)})")
            if k < (1 << width) - 1:
                terms.append(f"(from <= {literal(width, k)})" if k else f"(from == {literal(width, 0)})")
            lines.append(f"  assign covered[{k}] = {' & '.join(terms)};")
        return lines

    # ---------------------------------------------------------------- checking

    def checking(self) -> list[str]:
        plan = self.plan
        if not plan.checks:
            return []
        words, count = plan.checked_words, 16 * plan.checked_words
        lines = banner("Checking")
        several = words > 1
        lines += ["  // The value as it would be after the write."] if several else []
        if several:
            parts = []
            for k in range(words):
                top = 16 * plan.held_words - 16 * k
                old = f"held_q[{top - 1}:{top - 16}]"
                parts.append(f"covered[{k}] ? word_{k} : {old}")
            lines.append(f"  wire {bits(count)} value = {{" + (",\n" + " " * 30).join(f"{p}" for p in parts) + "};")
        else:
            lines.append("  wire [15:0] value = wb_dat_i;")
        swaps = sorted({p.width for p in plan.limited if p.width > 1 and p.word_order == "little"})
        kinds = {kind_of(p) for p in plan.limited if is_range(p)}
        limits = self.by_point(lambda point: self.limits(point, count))  # none: an `always @*` that nothing wakes in Icarus
        if kinds:
            lines += ["  // Limits, in an order in which unsigned numbers compare.  Without limits: all values."]
            lines += [f"  reg  {bits(count)} least, most;"]
        lines += ["  reg         is_signed;"] if SIGNED in kinds else []
        lines += ["  reg         is_float;"] if FLOAT in kinds else []
        for width in swaps:
            lines.append(f"  reg         is_little_{width};           // the first of {width} words is the low one")
        lists = [p for p in plan.limited if not is_range(p)]
        lines += ["  reg         listed;                // the value is one of an enum"] if lists else []
        if swaps:
            lines += self.swapped(words, swaps)
            value = "high_first"
        else:
            value = "value"
        if limits:
            lines += ["", "  always @* begin"]
            lines += [f"    least = {count}'d0;", f"    most  = {{{count}{{1'b1}}}};"] if kinds else []
            flags = ["is_signed"] * (SIGNED in kinds) + ["is_float"] * (FLOAT in kinds)
            lines += [f"    {flag} = 1'b0;" for flag in [*flags, *(f"is_little_{width}" for width in swaps)]]
            lines += [*limits, "  end"]
        lines.append("")
        if lists:  # a block of its own, since it reads what the one above sets
            lines += ["  always @* begin", "    listed = 1'b1;"]
            lines += [*self.by_point(lambda point: self.listed(point, count, value)), "  end", ""]
        order, sign = value, f"{value}[{count - 1}]"
        if FLOAT in kinds or SIGNED in kinds:
            flips = []
            if FLOAT in kinds:
                flips.append(f"{{{count}{{is_float & {sign}}}}}")
            top = " | ".join((["is_signed"] if SIGNED in kinds else []) + ([f"(is_float & ~{sign})"] if FLOAT in kinds else []))
            flips.append(f"{{{top}, {count - 1}'d0}}")
            order = f"{value} ^ " + " ^ ".join(flips)
        if kinds:
            lines.append(f"  wire {bits(count)} ordered = {order};")
        closes = " & closes" if plan.staged_words > 1 else ""
        refused = " | ".join(["ordered < least | ordered > most"] * bool(kinds) + ["~listed"] * bool(lists))
        lines += [
            "  reg         refuse_q;",
            f"  always @(posedge clk_i) refuse_q <= checks & space[0]{closes} & ({refused});",
        ]
        return lines

    def items_of(self, point: Point) -> list[Item]:
        return [Item(point, n) for n in range(point.count)]

    @staticmethod
    def swapped(words: int, widths: list[int]) -> list[str]:
        """The value with its most significant word on top."""
        count, choice = 16 * words, "value"
        for width in widths:
            parts = [f"value[{count - 16 * k - 1}:{count - 16 * k - 16}]" for k in reversed(range(width))]
            rest = [f"{count - 16 * width}'d0"] if width < words else []
            choice = f"is_little_{width} ? {{{', '.join(parts + rest)}}} :\n{' ' * 26}{choice}"
        return ["  // The most significant word on top", f"  wire {bits(count)} high_first = {choice};"]

    def by_point(self, statements: Callable[[Point], list[str]]) -> list[str]:
        """Statements about the limited point that the address is of."""
        plan, lines = self.plan, []
        chosen = [(point, found) for point in plan.limited if (found := statements(point))]
        plain = [(point, found) for point, found in chosen if point.kind != "memory"]
        if plain:
            terms = ["~in_memory"] * bool(plan.areas) + ["holding_is"] * plan.has_free_addresses(3)
            indent = "      " if terms else "    "
            lines += [f"    if ({' & '.join(terms)})"] if terms else []
            lines.append(f"{indent}case (holding)")
            for point, found in plain:
                keys = [
                    literal(plan.key_width(3), plan.key(3, a)) for item in self.items_of(point) for a in item.addresses
                ]
                lines += [f"{indent}  {line}" for line in fill(keys, ": begin")]
                lines += [f"{indent}    {line}" for line in found]
                lines.append(f"{indent}  end  // {point.name}")
            lines += [f"{indent}  default: ;", f"{indent}endcase"]
        for point, found in chosen:
            if point.kind == "memory":
                lines.append(f"    if ({between('address', point.at, point.last)}) begin  // {point.name}")
                lines += [f"      {line}" for line in found]
                lines.append("    end")
        return lines

    @staticmethod
    def listed(point: Point, count: int, value: str) -> list[str]:
        """The assignment that compares a value with an enum which is no range."""
        if is_range(point):
            return []
        top = slice_of(value, count, count - 1, count - point.bits)
        return ["listed = " + " | ".join(f"({top} == {literal(point.bits, e.raw)})" for e in point.enum) + ";"]

    @staticmethod
    def limits(point: Point, count: int) -> list[str]:
        """The assignments that give the limits of a point."""
        shift = count - point.bits
        lines = []
        if is_range(point):
            low, high = limits_of(point)
            kind = kind_of(point)
            lines += [
                f"least = {literal(count, low << shift)};",
                f"most  = {literal(count, (high << shift) | ((1 << shift) - 1))};",
            ]
            lines += ["is_signed = 1'b1;"] if kind == SIGNED else ["is_float = 1'b1;"] if kind == FLOAT else []
        if point.width > 1 and point.word_order == "little":
            lines.append(f"is_little_{point.width} = 1'b1;")
        return lines

    # ---------------------------------------------------------------- registers

    def registers(self) -> list[str]:
        points = [p for p in self.device.points if p.kind == "register"]
        if not points:
            return []
        lines = banner("Points that the master writes")
        loops = any(self.loops(p) for p in points)
        lines += ["  integer n;", ""] if loops else []
        for point in points:
            name, width = signal(point), point.bits * point.count
            reset = literal(width, whole_reset(point))
            lines.append(f"  // {place_of(point)}" + (f": {one_line(point.doc)}" if point.doc else ""))
            lines.append("  always @(posedge clk_i) begin")
            body = self.stores(point)
            lines += ["    " + line for line in body]
            kept = [f"{name}_q <= {reset};"]
            kept += [f"{name}_written_q <= {literal(point.size, 0)};"] if self.in_ram(point) else []
            cleared = kept[0] if len(kept) == 1 else f"begin {' '.join(kept)} end"
            lines.append(f"    if (rst_i) {cleared}" if body else f"    {cleared}")
            if point.strobe:
                lines += ["    " + line for line in self.strobes(point)]
            lines += ["  end", f"  assign {port(point, 'o')} = {name}_q;"]
            lines += [f"  assign {port(point, 'stb_o')} = {name}_stb_q;"] if point.strobe else []
            lines.append("")
        return lines[:-1]

    def loops(self, point: Point) -> bool:
        """True if the keys of an array of single addresses follow each other, and a loop is shorter."""
        space = SPACES[point.table]
        if not point.writable or point.kind != "register" or point.width > 1 or point.count < LOOP_FROM:
            return False
        keys = [self.plan.key(space, a) for a in range(point.at, point.last + 1)]
        return keys == list(range(keys[0], keys[0] + point.count))

    def hit(self, item: Item) -> str:
        """True while the address is one of the item."""
        space = SPACES[item.point.table]
        width, name = self.plan.key_width(space), KEYS[space]
        return " | ".join(f"{name} == {literal(width, self.plan.key(space, a))}" for a in item.addresses)

    def stores(self, point: Point) -> list[str]:
        """The statements that store what the master has written."""
        if not point.writable:
            return []
        space, name, plan = SPACES[point.table], signal(point), self.plan
        width = plan.key_width(space)
        write, data = ("write_coil", "wb_dat_i[0]") if space == 0 else ("write_holding", "wb_dat_i")
        if self.loops(point):
            first = plan.key(space, point.at)
            index = f"n[{width - 1}:0]" if first == 0 else f"{literal(width, first)} + n[{width - 1}:0]"
            target = f"{name}_q[n]" if space == 0 else f"{name}_q[16*n +: 16]"
            stored = self.stored(f"{target} <= {data};", f"{name}_written_q[n]" if self.in_ram(point) else "")
            return [
                f"for (n = 0; n < {point.count}; n = n + 1)",
                f"  if ({write} && {KEYS[space]} == {index}) {stored}",
            ]
        lines = []
        for item in self.items_of(point):
            if point.is_bit or point.width == 1:
                high, low = (item.index, item.index) if point.is_bit else item.word_bits(0)
                target = slice_of(f"{name}_q", point.bits * point.count, high, low)
                stored = self.stored(f"{target} <= {data};", self.flag(item, 0))
                lines.append(f"if ({write} && {self.hit(item)}) {stored}")
            else:
                lines.append(f"if (write_holding && closes && ({self.hit(item)})) begin")
                for word in range(point.width):
                    high, low = item.word_bits(word)
                    target = slice_of(f"{name}_q", point.bits * point.count, high, low)
                    stored = self.stored(f"{target} <= word_{word};", self.flag(item, word))
                    lines.append(f"  if (covered[{word}]) {stored}")
                lines.append("end")
        return lines

    def flag(self, item: Item, word: int) -> str:
        """The flag that a write of the word sets; nothing where there is none."""
        return self.written(item, word) if self.plan.in_ram(item) else ""

    @staticmethod
    def stored(statement: str, flag: str) -> str:
        """A store of a word, with that of its flag."""
        return f"begin {statement} {flag} <= 1'b1; end" if flag else statement

    def strobes(self, point: Point) -> list[str]:
        """The statements that tell of a write."""
        name = signal(point)
        if not point.writable:
            return [f"{name}_stb_q <= {literal(point.count, 0)};"]
        write = "write_coil" if point.is_bit else "write_holding"
        lines = []
        for item in self.items_of(point):
            target = slice_of(f"{name}_stb_q", point.count, item.index, item.index)
            closes = " && closes" if point.width > 1 else ""
            lines.append(f"{target} <= {write}{closes} && ({self.hit(item)}) && !rst_i;")
        return lines

    # ---------------------------------------------------------------- snapshots

    def snapshots(self) -> list[str]:
        plan = self.plan
        coils = self.device.freeze_coils()
        if not coils:
            return []
        lines = banner("Snapshots")
        for coil in coils:
            point = self.device.point(coil)
            width = plan.key_width(0)
            lines.append(f"  // Writing 1 to {coil} stores all of its points in one clock.")
            lines.append(
                f"  wire take_{coil} = write_coil & (coil == {literal(width, plan.key(0, point.at))}) & wb_dat_i[0];"
            )
            lines += ["  always @(posedge clk_i)"]
            lines += ["    if (rst_i) begin"]
            lines += [
                f"      {signal(f)}_frozen_q <= {literal(f.bits * f.count, whole_reset(f))};" for f in plan.frozen(coil)
            ]
            lines += [f"    end else if (take_{coil}) begin"]
            lines += [f"      {signal(f)}_frozen_q <= {signal(f)}_i;" for f in plan.frozen(coil)]
            lines += ["    end", ""]
        return lines[:-1]

    # ---------------------------------------------------------------- memory

    def memory(self) -> list[str]:
        plan = self.plan
        if not plan.areas:
            return []
        size = plan.memory_words
        width = max(1, (size - 1).bit_length())
        own = "checks ? {1'b0, space[0], space[0]} : space" if plan.checks else "space"
        lines = banner("Memory")
        lines += [
            "  // One port and two users: while one has the bus cycle the other waits, so a block is one piece for both.",
            "  reg         host_ready_q = 1'b0;",
            f"  wire [2:0]  the_space   = host_q ? host_adr_i[18:16] : {own};",
            "  wire [15:0] the_address = host_q ? host_adr_i[15:0] : address;",
            "  reg         in_memory;",
            "  // The memory is smaller than the addresses:",
            "  // verilator lint_off UNUSED",
            "  reg  [15:0] place;",
            "  // verilator lint_on UNUSED",
            "",
            "  always @* begin",
            "    in_memory = 1'b0;",
            "    place = the_address;",
        ]
        for area in plan.areas:
            lines += self.area(area)
        store = "(host_q ? host_ready_q & host_cyc_i & host_stb_i & host_we_i : " + ("write" if plan.writes_memory else "1'b0") + ")"
        lines += [
            "  end",
            "",
            f"  reg  [15:0] memory [0:{size - 1}];",
            "  reg  [15:0] memory_q;",
            f"  wire        store = in_memory & {store};",
            "  wire [15:0] store_data = host_q ? host_dat_i : wb_dat_i;",
            "  integer     m;",
            "",
            "  initial begin",
            f"    for (m = 0; m < {size}; m = m + 1) memory[m] = 16'd0;",
        ]
        for area in plan.areas:
            lines += [
                f"    memory[{area.place + n}] = 16'd{word};" for n, word in enumerate(area.resets) if word
            ]
        lines += [
            "  end",
            "",
            "  always @(posedge clk_i) begin",
            f"    if (store) memory[place[{width - 1}:0]] <= store_data;",
            f"    memory_q <= memory[place[{width - 1}:0]];",
            "  end",
            "",
            "  always @(posedge clk_i) begin",
            "    host_q       <= host_cyc_i & (host_q | ~wb_cyc_i) & ~rst_i;",
            "    host_ready_q <= host_q & host_cyc_i & host_stb_i & ~host_ready_q & ~rst_i;",
            "  end",
            "",
            "  wire host_done = host_ready_q & host_cyc_i & host_stb_i;",
            "  assign host_dat_o = memory_q;",
            "  assign host_ack_o = host_done & in_memory;",
            "  assign host_err_o = host_done & ~in_memory;",
        ]
        for point in self.device.points:
            if point.kind == "memory" and point.strobe:
                lines += self.memory_strobe(point)
        return lines

    def area(self, area: Area) -> list[str]:
        """Where an area is in the memory."""
        space = f"the_space == {SPACE_NAMES[area.space]}"
        comment = f"  // {area.name}"

        def rows(condition: str, at: int) -> list[str]:
            move = "" if at == area.place else f" - 16'd{at - area.place}" if at > area.place else f" + 16'd{area.place - at}"
            return [
                f"    if ({condition}) begin{comment}",
                "      in_memory = 1'b1;",
                f"      place = the_address{move};",
                "    end",
            ]

        if area.space != FILES_SPACE:
            return rows(f"{space} && {between('the_address', area.at, area.last)}", area.at)
        host = between("the_address", area.host_at, area.host_at + area.last)
        return rows(f"{space} && host_q && {host}", area.host_at) + rows(
            f"{space} && !host_q && grant_file_i == 16'd{area.file}", 0
        )

    def memory_strobe(self, point: Point) -> list[str]:
        name, lines = signal(point), []
        lines += ["", "  always @(posedge clk_i) begin"]
        for item in self.items_of(point):
            target = slice_of(f"{name}_stb_q", point.count, item.index, item.index)
            last = item.addresses[-1]
            hit = f"address == 16'd{last}"
            if point.width > 1:
                hit = f"({hit} || (address == grant_last_i && {between('address', item.at, last)}))"
            lines.append(f"    {target} <= write && space == {SPACE_NAMES[SPACES[point.table]]} && {hit} && !rst_i;")
        return [*lines, "  end", f"  assign {port(point, 'stb_o')} = {name}_stb_q;"]

    # ---------------------------------------------------------------- answers

    def answers(self) -> list[str]:
        plan = self.plan
        lines = banner("Answers")
        if plan.held_words > 1:
            width = (plan.held_words - 1).bit_length()
            lines += ["  reg  [15:0] shown;", "  always @* begin", "    case (part)"]
            for k in range(plan.held_words - 1):
                top = 16 * (plan.held_words - k)
                lines.append(f"      {literal(width, k)}: shown = held_q[{top - 1}:{top - 16}];")
            lines += ["      default: shown = held_q[15:0];", "    endcase", "  end", ""]
            shown = "shown"
        else:
            shown = "held_q" if plan.keys else "16'd0"
        # Gaps of a table that has no items here: held_q is that of another table.
        gaps = [f"space == {SPACE_NAMES[s]}" for s in range(4) if plan.has_free_addresses(s) and not plan.has(s)]
        if gaps and plan.keys:
            shown = f"({' || '.join(gaps)}) ? 16'd0 : {shown}"
        if plan.reads_back:
            shown = f"from_back_q ? back_q : {shown}"
        if plan.areas:
            shown = f"in_memory ? memory_q : {shown}" if plan.keys or gaps else "memory_q"
        refuse = "refuse_q" if plan.checks else ""
        lines += [
            "  assign grant_ack_o = grant_ack_q & grant_req_i;",
            f"  assign wb_dat_o    = {shown};",
            f"  assign wb_ack_o    = done{' & ~(checks & refuse_q)' if refuse else ''};",
            f"  assign wb_err_o    = {'done & checks & refuse_q' if refuse else chr(49) + chr(39) + 'b0'};",
            "  assign exception_o = (grant_ack_o & grant_refused_q) ? `MB_EX_ILLEGAL_DATA_ADDRESS :",
            "                       wb_err_o ? `MB_EX_ILLEGAL_DATA_VALUE : 4'd0;",
            "",
            "  // What this map does not need of the bus:",
        ]
        unused = ["grant_first_i", "grant_file_i", "wb_we_i", "wb_dat_i", "space", "address"]
        unused += ["host_adr_i"] if plan.areas else []
        lines.append(f"  wire unused = &{{1'b0, {', '.join(unused)}}};")
        return lines


# -------------------------------------------------------------------- helpers


def is_staged(item: Item) -> bool:
    """True if the item is written in one piece of several words."""
    return item.point.writable and item.point.kind == "register" and item.point.width > 1


def banner(title: str) -> list[str]:
    return [f"  // {'-' * 66} {title}", ""]


def place_of(point: Point) -> str:
    """`holding registers 4 and 5, f32`"""
    what = TABLE_WORDS[SPACES[point.table]]
    what += f" {point.at}" if point.size == 1 else f"s {point.at} to {point.last}"
    return what + (f", {point.type}" if not point.is_bit and point.type != "u16" else "")


def row_text(row: Row, space: int) -> str:
    """`coils 0 to 3`"""
    what = f"{TABLE_WORDS[space]} {row.low}" if row.low == row.high else f"{TABLE_WORDS[space]}s {row.low} to {row.high}"
    return what + (f" of file {row.file}" if row.file else "")


def one_line(text: str) -> str:
    return " ".join(text.split())


def between(name: str, low: int, high: int) -> str:
    """`name` from `low` to `high`; nothing is compared that is always so."""
    if low == high:
        return f"({name} == 16'd{low})"
    terms = ([f"{name} >= 16'd{low}"] if low else []) + ([f"{name} <= 16'd{high}"] if high < 65535 else [])
    return f"({' && '.join(terms)})" if terms else "1'b1"


def port_lines(ports: list[tuple[str, str, str, str]]) -> list[str]:
    return aligned(ports)


def kind_of(point: Point) -> int:
    """How values of a point whose limits are a range compare."""
    return FLOAT if point.is_float else SIGNED if point.is_signed else UNSIGNED


def is_range(point: Point) -> bool:
    """True if what a point accepts is a range; else it is a list."""
    if point.minimum is not None or point.maximum is not None:
        return True
    values = sorted(i.raw for i in point.enum)
    return not point.is_signed and not point.is_float and len(runs(values)) < COMPARED_ENUM


def order(point: Point, raw: int) -> int:
    """A raw value in the order in which unsigned numbers compare."""
    top = 1 << (point.bits - 1)
    if point.is_signed:
        return raw ^ top
    if point.is_float:
        return raw ^ ((1 << point.bits) - 1) if raw & top else raw | top
    return raw


def limits_of(point: Point) -> tuple[int, int]:
    """(least, most) that a point accepts, as `order` gives them."""
    if point.minimum is None and point.maximum is None:
        values = [item.raw for item in point.enum]
        return min(values), max(values)
    top = 1 << (point.bits - 1)
    infinite = (0x7F800000 if point.bits == 32 else 0x7FF << 52) if point.is_float else 0
    low, high = point.minimum, point.maximum
    if point.is_float:
        low = infinite | top if low is None else top if low in (0, top) else low  # -0.0 is not less than 0.0
        high = infinite if high is None else 0 if high in (0, top) else high
    elif point.is_signed:
        low, high = top if low is None else low, top - 1 if high is None else high
    else:
        low, high = low or 0, (1 << point.bits) - 1 if high is None else high
    return order(point, low), order(point, high)
