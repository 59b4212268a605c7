// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// panel - the page over a live device.  Its back end is the device's WebSocket (socket.js) or the core in the page itself
// (wasm.js); both have call(operation, arguments) -> promise and onEvent(listener).
"use strict";

const Panel = (() => {
  const $ = (id) => document.getElementById(id);
  const POLL_MS = 700, ROWS_KEPT = 500;
  const BIT_CELLS = 64, WORD_CELLS = 40;
  const TITLES = { points: "Points", coils: "Coils", discretes: "Discrete inputs", inputs: "Input registers",
    holdings: "Holding registers", files: "Files" };
  const COUNTER_WORDS = { bus_message: "bus messages", comm_error: "communication errors", exception: "exceptions",
    slave_message: "messages for this slave", no_response: "not answered", nak: "NAKs", busy: "busy answers",
    overrun: "overruns", event: "events" };
  const ERROR_WORDS = { frame: "good frames, for any slave", parity: "wrong parity", framing: "no stop bit",
    overrun: "too early", crc: "wrong CRC", short: "too short", long: "too long", gap: "gap above t1.5" };
  const HARMLESS = ["broadcast", "other address", "listen-only"];     // silences that are nobody's mistake
  const EXCEPTIONS = { 0: "none", 1: "01 illegal function", 2: "02 illegal address", 3: "03 illegal value", 4: "04 device failure",
    5: "05 acknowledge", 6: "06 busy", 7: "07 NAK" };

  let backend, device = {}, connected = false;

  const element = (tag, attributes = {}, ...children) => {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (name === "text") made.textContent = value;
      else if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
      else made.setAttribute(name, value);
    }
    made.append(...children);
    return made;
  };

  const trouble = (text) => {
    $("trouble").textContent = text || "";
    $("trouble").hidden = !text;
  };

  // On a line with several slaves: which one the tables, the state and the counters are of.
  const ofSlave = ["read", "write", "state", "set", "status"];
  const call = (op, given = {}) =>
    backend.call(op, (device.slaves || []).length > 1 && ofSlave.includes(op) ? { ...given, slave: Number($("slave").value) } : given);

  // An operation; what it refuses is shown, and gives undefined.
  const ask = async (op, given) => {
    try {
      const result = await call(op, given);
      if ($("trouble").dataset.op === op) trouble("");
      return result;
    } catch (error) {
      $("trouble").dataset.op = op;
      trouble(error.message);
      return undefined;
    }
  };

  const numberOf = (text) => (/^-?0x/i.test(text.trim()) ? parseInt(text, 16) : Number(text));

  // ------------------------------------------------------------------ tables

  let table = "holdings", first = 0, cells = [], editing = null;

  const tablesOf = () => {
    const found = Object.entries(device.tables || {}).filter(([, [, size]]) => size).map(([name]) => name);
    if (device.files && device.files[0]) found.push("files");
    if ((device.points || []).length) found.unshift("points");
    return found;
  };
  const limits = () => (table === "files" ? [0, device.files[0] * device.files[1]] : (device.tables || {})[table] || [0, 0]);
  const isBits = () => table === "coils" || table === "discretes";
  const shown = () => (isBits() ? BIT_CELLS : WORD_CELLS);
  const writtenAs = (value) => {
    const base = Number($("table-base").value);
    if (isBits()) return String(value);
    if (base === 16) return value.toString(16).toUpperCase().padStart(4, "0");
    return String(base < 0 && value > 32767 ? value - 65536 : value);
  };

  const chooseTable = (name) => {
    table = name;
    first = name === "points" ? 0 : limits()[0];
    for (const tab of $("table-tabs").children) {
      const chosen = tab.dataset.table === name;
      tab.setAttribute("aria-selected", chosen);
      tab.tabIndex = chosen ? 0 : -1;
    }
    $("table-range").hidden = name === "points";
    $("base-label").hidden = isBits();
    buildCells();
  };

  const buildTabs = () => {
    $("table-tabs").replaceChildren(...tablesOf().map((name) =>
      element("button", { type: "button", role: "tab", "data-table": name, text: TITLES[name], onclick: () => chooseTable(name) })));
    chooseTable(tablesOf().includes(table) && table !== "points" && !tablesOf().includes("points") ? table : tablesOf()[0] || "holdings");
  };

  const recordName = (item) => `${Math.floor(item / device.files[1]) + 1}:${item % device.files[1]}`;

  const buildCells = () => {
    editing = null;
    const points = table === "points";
    $("cells").className = points ? "points" : isBits() ? "bits" : "";
    const [base, size] = limits();
    first = Math.min(Math.max(first, base), Math.max(base, base + size - 1));
    const count = points ? device.points.length : Math.min(shown(), base + size - first);
    $("table-first").value = first;
    cells = Array.from({ length: Math.max(count, 0) }, (_, i) => {
      const item = first + i, point = points ? device.points[i] : null;
      const cell = points
        ? element("div", {}, element("small", { text: `${TITLES[point.table] || point.table} ${point.first}${point.access ? ` · ${point.access}` : ""}` }),
          element("b", { text: point.name, title: point.description || "" }), element("span", { text: "…" }))
        : element("div", {}, element("small", { text: table === "files" ? recordName(item) : item }), element("span", { text: "…" }));
      cell.className = "cell";
      cell.tabIndex = i ? -1 : 0;
      cell.setAttribute("role", "gridcell");
      Object.assign(cell, { item, point, value: undefined });
      cell.addEventListener("click", () => edit(cell));
      return cell;
    });
    $("cells").replaceChildren(...cells);
    $("table-note").textContent = points ? "Click a value to change it." :
      isBits() ? "Click or Enter switches a bit." : "Click or Enter edits; 0x… is hexadecimal.";
    refresh();
  };

  const showCell = (cell, value, text) => {
    if (cell === editing) return;
    const span = cell.querySelector("span");
    const was = cell.value;
    cell.value = value;
    span.textContent = text;
    cell.classList.toggle("on", isBits() && value === 1);
    if (was !== undefined && String(was) !== String(value)) {
      cell.classList.add("flash");
      setTimeout(() => cell.classList.remove("flash"), 120);
    }
  };

  const refresh = async () => {
    if (!cells.length) return;
    const [of, from, list] = [table, first, cells];
    let got;
    try {
      got = of === "points" ? await call("points") : await call("read", { table: of, first: from, count: list.length });
    } catch {
      return;                                   // the connection tells of itself
    }
    if (list !== cells) return;
    list.forEach((cell, i) => {
      if (of === "points") {
        const point = got.points[cell.point.name];
        if (point) showCell(cell, point.text, point.text);
      } else {
        showCell(cell, got.values[i], writtenAs(got.values[i]));
      }
    });
  };

  const edit = async (cell) => {
    if (editing === cell) return;
    if (cell.point && cell.point.host === false) return;
    if (!cell.point && isBits()) {
      await ask("write", { table, first: cell.item, values: [cell.value ? 0 : 1] });
      return refresh();
    }
    editing = cell;
    const span = cell.querySelector("span");
    const input = element("input", { "aria-label": cell.point ? cell.point.name : `${TITLES[table]} ${cell.item}` });
    input.value = cell.point ? String(cell.value === undefined ? "" : cell.value).replace(/ \S*$/, (unit) => (unit.trim() === cell.point.unit ? "" : unit)) : writtenAs(cell.value || 0);
    if (Number($("table-base").value) === 16 && !cell.point) input.value = `0x${input.value}`;
    const done = async (keep) => {
      if (editing !== cell) return;
      editing = null;
      input.replaceWith(span);
      if (keep && cell.point) {
        await ask("write_point", { name: cell.point.name, value: input.value });
      } else if (keep) {
        const value = numberOf(input.value);
        await ask("write", { table, first: cell.item, values: [value < 0 && value >= -32768 ? value + 65536 : value] });
      }
      refresh();
      cell.focus();
    };
    input.addEventListener("keydown", (event) => {
      event.stopPropagation();
      if (event.key === "Enter") done(true);
      if (event.key === "Escape") done(false);
    });
    input.addEventListener("blur", () => done(true));
    span.replaceWith(input);
    input.focus();
    input.select();
  };

  $("cells").addEventListener("keydown", (event) => {
    const at = cells.indexOf(document.activeElement);
    if (at < 0) return;
    const across = getComputedStyle($("cells")).gridTemplateColumns.split(" ").length;
    const move = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: across, ArrowUp: -across }[event.key];
    if (move) {
      const to = cells[at + move];
      if (to) {
        cells[at].tabIndex = -1;
        to.tabIndex = 0;
        to.focus();
      }
    } else if (event.key === "Enter" || event.key === " ") {
      edit(cells[at]);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  });
  $("table-first").addEventListener("change", (event) => { first = Number(event.target.value) || 0; buildCells(); });
  $("table-back").addEventListener("click", () => { first -= shown(); buildCells(); });
  $("table-on").addEventListener("click", () => {
    const [base, size] = limits();
    if (first + shown() < base + size) first += shown();
    buildCells();
  });
  $("table-base").addEventListener("change", buildCells);

  // ------------------------------------------------------------------ frames

  const rows = new Map();
  let pending = [], paused = false, chosen = null, scheduled = false;

  const clockTime = (seconds) => {
    const at = new Date(seconds * 1000), two = (n) => String(n).padStart(2, "0");
    return `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}.${String(at.getMilliseconds()).padStart(3, "0")}`;
  };

  const addFrame = (frame) => {
    const asks = frame.direction === "request";
    const words = element("div", { class: "words", text: frame.words });
    const tag = frame.injected ? [element("div", { class: "tag", text: Faults.inWords(frame.injected) })] : [];
    const row = element("li", { role: "option", class: frame.direction + (frame.exception ? " exception" : ""), "aria-selected": "false",
      id: `frame-${frame.n}`, "data-n": frame.n },
    element("time", { text: clockTime(frame.time) }),
    element("span", { class: "dir", text: asks ? "→" : "←", title: asks ? "from the master" : "from the slave" }),
    element("div", {}, words, element("code", { text: frame.hex }), ...tag, element("div", { class: "why" })));
    row.frame = frame;
    rows.set(frame.n, row);
    $("list").append(row);
    while ($("list").children.length > ROWS_KEPT) {
      const old = $("list").firstElementChild;
      rows.delete(old.frame.n);
      old.remove();
    }
    if (frame.silence) addSilence(frame.silence);
    if (frame.delivered) addDelivered(frame.delivered);
  };

  const addSilence = ({ to, verdict, words }) => {
    const row = rows.get(to);
    if (!row) return;
    const harmless = HARMLESS.includes(verdict);
    row.classList.add("silent");
    row.classList.toggle("error", !harmless);
    const why = row.querySelector(".why");
    why.classList.toggle("error", !harmless);
    why.textContent = `no answer: ${words}`;
  };

  const addDelivered = ({ to, hex, words }) => {
    const row = rows.get(to);
    if (row) row.querySelector(".why").textContent = hex ? `the master got ${hex}: ${words}` : "the master got nothing of it";
  };

  const flush = () => {
    scheduled = false;
    const list = $("list"), atEnd = list.scrollHeight - list.scrollTop - list.clientHeight < 40;
    const work = pending;
    pending = [];
    for (const event of work) {
      if (event.event === "frame") addFrame(event.frame);
      else if (event.event === "silence") addSilence(event);
      else addDelivered(event);
    }
    if (atEnd) list.scrollTop = list.scrollHeight;
  };
  const later = (event) => {
    pending.push(event);
    if (pending.length > 4 * ROWS_KEPT) pending.splice(0, 2 * ROWS_KEPT);
    if (!scheduled && !paused) {
      scheduled = true;
      setTimeout(flush, 60);
    }
  };

  const choose = (row) => {
    if (!row) return;
    if (chosen) chosen.setAttribute("aria-selected", "false");
    chosen = row;
    row.setAttribute("aria-selected", "true");
    $("list").setAttribute("aria-activedescendant", row.id);
    row.scrollIntoView({ block: "nearest" });
    Wave.show(row.frame.n);
  };
  $("list").addEventListener("click", (event) => choose(event.target.closest("li")));
  $("list").addEventListener("keydown", (event) => {
    const step = { ArrowDown: "nextElementSibling", ArrowUp: "previousElementSibling" }[event.key];
    let to = null;
    if (step) {
      to = chosen && chosen.isConnected ? chosen[step] : $("list").lastElementChild;
      while (to && to.offsetParent === null) to = to[step];
    } else if (event.key === "Home") to = $("list").firstElementChild;
    else if (event.key === "End") to = $("list").lastElementChild;
    else if (event.key === "Enter") $("canvas").focus();
    else return;
    event.preventDefault();
    choose(to);
  });
  const pause = () => {
    paused = !paused;
    $("pause").setAttribute("aria-pressed", paused);
    $("pause").textContent = paused ? "Continue" : "Pause";
    if (!paused) flush();
  };
  $("pause").addEventListener("click", pause);
  $("clear").addEventListener("click", () => {
    rows.clear();
    chosen = null;
    $("list").replaceChildren();
  });
  $("only-bad").addEventListener("change", (event) => $("list").classList.toggle("only-bad", event.target.checked));

  // ------------------------------------------------------------------ waveform

  const Wave = (() => {
    const canvas = $("canvas"), LEFT = 42, LANES = ["rxd", "txd", "de"];
    let data = null, from = 0, to = 1, whole = [0, 1], hover = null;

    const ms = (cycles) => cycles * 1000 / data.clock_hz;
    const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
    const width = () => canvas.clientWidth - LEFT - 6;
    const x = (cycle) => LEFT + (cycle - from) / (to - from) * width();

    const show = async (n) => {
      const got = await ask("pins", { n });
      if (!got || chosen?.frame.n !== n) return;
      data = got;
      if (!data.edges.length) data.edges = [[data.start, 6]];
      const ends = data.characters.map((c) => c.start + data.length * data.bit_time);
      const last = Math.max(data.end + data.t35 * 1.15, ...ends, data.edges[data.edges.length - 1][0]);
      const margin = (last - data.start) * 0.02 + data.bit_time;
      whole = [data.start - margin, last + margin];
      [from, to] = whole;
      $("wave-title").textContent = `Frame ${data.n}, ${data.format}, ${Math.round(data.clock_hz / data.bit_time)} baud`;
      describe();
      draw();
    };

    const gaps = () => {
      const list = data.characters.filter((c) => c.pin === "rxd"), found = [];
      for (let i = 1; i < list.length; ++i) {
        const end = list[i - 1].start + data.length * data.bit_time, silence = list[i].start - end;
        if (silence > data.bit_time / 2) found.push({ end, start: list[i].start, silence, bad: silence > data.t15 && data.mode !== "ascii" });
      }
      return found;
    };

    const describe = () => {
      const heard = data.characters.filter((c) => c.pin === "rxd"), said = data.characters.filter((c) => c.pin === "txd");
      const parts = [`${heard.length} characters in ${ms(data.end - data.start).toFixed(2)} ms`];
      for (const gap of gaps()) parts.push(`gap of ${ms(gap.silence).toFixed(2)} ms${gap.bad ? `, more than t1.5 (${ms(data.t15).toFixed(2)} ms)` : ""}`);
      for (const c of data.characters) if (c.errors.length) parts.push(`${c.pin} ${hexOf(c.data)}: ${c.errors.map((e) => (e === "parity" ? "wrong parity" : "no stop bit")).join(", ")}`);
      parts.push(said.length ? `answer ${ms(said[0].start - data.end).toFixed(2)} ms after the end${data.mode === "ascii" ? "" : `, t3.5 is ${ms(data.t35).toFixed(2)} ms`}` : "no answer");
      $("wave-note").textContent = `${parts.join("; ")}.`;
      canvas.setAttribute("aria-label", `Waveform of frame ${data.n}: ${parts.join("; ")}`);
    };
    const hexOf = (value) => value.toString(16).toUpperCase().padStart(2, "0");

    const draw = () => {
      const scale = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
      canvas.width = w * scale;
      canvas.height = h * scale;
      const g = canvas.getContext("2d");
      g.scale(scale, scale);
      g.clearRect(0, 0, w, h);
      g.font = "11px ui-monospace, 'DejaVu Sans Mono', monospace";
      if (!data) {
        g.fillStyle = colour("soft");
        g.fillText("The waveform of a frame is drawn here.", LEFT, h / 2);
        return;
      }
      const top = 44, laneHeight = (h - top - 22) / 3, swing = laneHeight * 0.52;
      const laneTop = (i) => top + i * laneHeight + laneHeight * 0.3;
      axis(g, w, h);
      marks(g, h);
      g.save();
      g.beginPath();
      g.rect(LEFT, 0, w - LEFT, h);
      g.clip();
      LANES.forEach((name, i) => lane(g, name, i, laneTop(i), swing));
      data.characters.forEach((c) => character(g, c, laneTop(c.pin === "rxd" ? 0 : 1), swing));
      cursor(g, h);
      g.restore();
      LANES.forEach((name, i) => {
        g.fillStyle = colour(["request", "answer", "driver"][i]);
        g.textAlign = "left";
        g.font = "bold 12px ui-monospace, 'DejaVu Sans Mono', monospace";
        g.fillText(name, 6, laneTop(i) + swing / 2 + 4);
      });
    };

    const axis = (g, w, h) => {
      const rough = ms(to - from) / Math.max(width() / 90, 1), power = 10 ** Math.floor(Math.log10(rough));
      const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough);
      g.strokeStyle = colour("rule");
      g.fillStyle = colour("soft");
      g.textAlign = "center";
      for (let k = Math.ceil(ms(from - data.start) / step); k * step <= ms(to - data.start); ++k) {
        const at = x(data.start + k * step * data.clock_hz / 1000);
        if (at < LEFT) continue;
        g.beginPath();
        g.moveTo(at, 34);
        g.lineTo(at, h - 16);
        g.stroke();
        g.fillText(`${Number((k * step).toPrecision(6))} ms`, Math.min(at, w - 24), h - 4);
      }
    };

    // t1.5 and t3.5 from the end of the last character, and gaps inside the frame.
    const marks = (g, h) => {
      const label = (cycle, text, row, name) => {
        const at = x(cycle);
        if (at < LEFT || at > canvas.clientWidth) return;
        g.strokeStyle = g.fillStyle = colour(name);
        g.setLineDash([4, 3]);
        g.beginPath();
        g.moveTo(at, 16 + row * 11);
        g.lineTo(at, h - 16);
        g.stroke();
        g.setLineDash([]);
        g.textAlign = at > canvas.clientWidth - 50 ? "right" : "left";
        g.fillText(text, at + (g.textAlign === "left" ? 3 : -3), 14 + row * 11);
      };
      if (data.mode !== "ascii") {               // which has no t1.5 and no t3.5
        label(data.end + data.t15, "t1.5", 1, "soft");
        label(data.end + data.t35, "t3.5", 0, "ink");
      }
      for (const gap of gaps()) {
        if (!gap.bad) continue;
        g.fillStyle = colour("bad");
        g.globalAlpha = 0.14;
        g.fillRect(x(gap.end), 18, x(gap.start) - x(gap.end), h - 34);
        g.globalAlpha = 1;
        label(gap.end + data.t15, "t1.5 passed", 0, "bad");
      }
    };

    const lane = (g, name, i, y, swing) => {
      const pin = 2 - i, level = (bit) => y + (bit ? 0 : swing);
      g.strokeStyle = colour(["request", "answer", "driver"][i]);
      g.lineWidth = 1.5;
      g.beginPath();
      let value = i === 2 ? 0 : 1;
      for (const [cycle, pins] of data.edges) if (cycle <= from) value = pins >> pin & 1;
      g.moveTo(LEFT, level(value));
      for (const [cycle, pins] of data.edges) {
        const next = pins >> pin & 1;
        if (cycle <= from || next === value) continue;
        if (cycle > to) break;
        g.lineTo(x(cycle), level(value));
        g.lineTo(x(cycle), level(next));
        value = next;
      }
      g.lineTo(x(to), level(value));
      g.stroke();
      g.lineWidth = 1;
    };

    const character = (g, c, y, swing) => {
      const end = c.start + data.length * data.bit_time, wide = x(end) - x(c.start);
      if (x(end) < LEFT || x(c.start) > canvas.clientWidth) return;
      g.fillStyle = colour(c.errors.length ? "bad" : "ink");
      g.textAlign = "center";
      if (wide > 17) g.fillText(hexOf(c.data), x(c.start) + wide / 2, y - 5);
      g.strokeStyle = colour(c.errors.length ? "bad" : "soft");
      g.beginPath();
      g.moveTo(x(c.start) + 1, y - 2.5);
      g.lineTo(x(end) - 1, y - 2.5);
      g.stroke();
      if (wide / data.length < 6) return;
      // The bits as sampled: S start, P parity, E end.
      const parity = data.format[1] !== "N", last = Number(data.format[0]);
      for (let k = 0; k < data.length; ++k) {
        const middle = c.start + (k + 0.5) * data.bit_time, bit = levelAt(middle, c.pin);
        g.fillStyle = colour(c.pin === "rxd" ? "request" : "answer");
        g.beginPath();
        g.arc(x(middle), y + (bit ? 0 : swing), 2.2, 0, 7);
        g.fill();
        if (wide / data.length < 11) continue;
        g.fillStyle = colour("soft");
        const name = k === 0 ? "S" : k <= last ? String(bit) : parity && k === last + 1 ? `P${bit}` : bit ? "E" : "E!";
        g.fillText(name, x(middle), y + swing + 12);
      }
    };

    const levelAt = (cycle, pin) => {
      const shift = pin === "rxd" ? 2 : 1;
      let low = 0, high = data.edges.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (data.edges[middle][0] <= cycle) low = middle + 1;
        else high = middle;
      }
      return low ? data.edges[low - 1][1] >> shift & 1 : 1;
    };

    const cursor = (g, h) => {
      if (hover === null) return;
      const cycle = from + (hover - LEFT) / width() * (to - from);
      g.strokeStyle = colour("soft");
      g.fillStyle = colour("ink");
      g.beginPath();
      g.moveTo(hover, 16);
      g.lineTo(hover, h - 16);
      g.stroke();
      g.textAlign = hover > canvas.clientWidth / 2 ? "right" : "left";
      g.fillText(`${ms(cycle - data.start).toFixed(3)} ms`, hover + (g.textAlign === "left" ? 4 : -4), 36);
    };

    const zoom = (factor, at = 0.5) => {
      if (!data) return;
      const span = Math.min(Math.max((to - from) * factor, 6 * data.bit_time), whole[1] - whole[0]);
      const centre = from + (to - from) * at;
      from = Math.min(Math.max(centre - span * at, whole[0]), whole[1] - span);
      to = from + span;
      draw();
    };
    const move = (part) => {
      if (!data) return;
      const span = to - from;
      from = Math.min(Math.max(from + part * span, whole[0]), whole[1] - span);
      to = from + span;
      draw();
    };
    const all = () => {
      [from, to] = whole;
      draw();
    };

    canvas.addEventListener("wheel", (event) => {
      if (!data || !(event.ctrlKey || document.activeElement === canvas)) return;
      event.preventDefault();
      zoom(event.deltaY > 0 ? 1.25 : 0.8, (event.offsetX - LEFT) / width());
    }, { passive: false });
    let drag = null;
    canvas.addEventListener("pointerdown", (event) => { drag = event.offsetX; canvas.setPointerCapture(event.pointerId); });
    canvas.addEventListener("pointerup", () => { drag = null; });
    canvas.addEventListener("pointermove", (event) => {
      hover = event.offsetX > LEFT ? event.offsetX : null;
      if (drag !== null && data) {
        const by = (drag - event.offsetX) / width();
        drag = event.offsetX;
        move(by);
      } else {
        draw();
      }
    });
    canvas.addEventListener("pointerleave", () => { hover = null; draw(); });
    canvas.addEventListener("keydown", (event) => {
      const act = { "+": () => zoom(0.6), "=": () => zoom(0.6), "-": () => zoom(1.7), ArrowLeft: () => move(-0.15),
        ArrowRight: () => move(0.15), 0: all }[event.key];
      if (!act) return;
      event.preventDefault();
      event.stopPropagation();
      act();
    });
    $("zoom-in").addEventListener("click", () => zoom(0.6));
    $("zoom-out").addEventListener("click", () => zoom(1.7));
    $("zoom-all").addEventListener("click", all);
    new ResizeObserver(draw).observe(canvas);
    return { show, draw };
  })();

  // ------------------------------------------------------------------ counters and state

  const figures = (list, words, values) => {
    for (const [name, said] of Object.entries(words)) {
      let dd = list.querySelector(`[data-name="${name}"]`);
      if (!dd) {
        dd = element("dd", { "data-name": name });
        list.append(element("dt", { text: said }), dd);
      }
      const value = values && name in values ? String(values[name]) : "–";
      dd.classList.toggle("changed", dd.textContent !== "" && dd.textContent !== value);
      dd.classList.toggle("zero", value === "0" || value === "–");
      dd.textContent = value;
    }
  };

  const showStatus = (status) => {
    for (const part of [$("counts"), $("log-title"), $("log")]) part.hidden = !status.counters;
    $("no-counters").hidden = Boolean(status.counters);
    if (status.counters) figures($("counts"), COUNTER_WORDS, status.counters);
    figures($("errors"), ERROR_WORDS, status.errors);
    const story = [...status.story].reverse();
    $("log").replaceChildren(...(story.length ? story : ["empty"]).map((line) =>
      element("li", { text: line, class: /bad|refused|failed|too long/.test(line) ? "bad" : "" })));
    lights.listen_only = status.listen_only;
    showLights();
    showFacts(status);
  };

  const showFacts = (status) => {
    const facts = inputs().includes("diagnostic") ? { "diagnostic register": status.register_words } : {};
    if (device.link) facts["serial port"] = device.link;
    if (status.stats) facts.traffic = `${status.stats.requests} requests, ${status.stats.answers} answers, ${status.stats.silent} without`;
    if (status.stats && status.stats.late) facts.late = `the simulation lagged ${status.stats.late} times`;
    if (device.script) facts.script = device.script;
    $("facts").replaceChildren(...Object.entries(facts).flatMap(([name, value]) => [element("dt", { text: name }), element("dd", { text: value })]));
  };

  const inputs = () => (device.features || {}).state || [];  // of the device, for its state
  const lights = { busy: 0, failure: 0, listen_only: 0, run_indicator: 1, write_lock: 0 };
  const showLights = () => {
    const on = [[connected ? "connected" : "not connected", connected ? "good" : "bad"]];
    if (inputs().includes("run_indicator")) on.push(lights.run_indicator ? ["running", "good"] : ["stopped", "bad"]);
    if (lights.busy) on.push(["busy", "bad"]);
    if (lights.failure) on.push([`failure ${EXCEPTIONS[lights.failure] || lights.failure}`, "bad"]);
    if (lights.write_lock) on.push(["write lock", "bad"]);
    if (lights.listen_only) on.push(["listen-only", "bad"]);
    const same = on.map(([text]) => text).join();
    if ($("lights").dataset.shown === same) return;
    $("lights").dataset.shown = same;
    $("lights").replaceChildren(...on.map(([text, kind]) => element("span", { class: `light ${kind}`, text })));
  };

  const showState = (state) => {
    Object.assign(lights, state);
    for (const field of $("state-form").elements) {
      if (!(field.name in state) || field === document.activeElement) continue;
      if (field.type === "checkbox") field.checked = Boolean(state[field.name]);
      else field.value = state[field.name];
    }
    showLights();
  };
  $("state-form").elements.failure.append(...Array.from({ length: 16 }, (_, code) =>
    element("option", { value: code, text: EXCEPTIONS[code] || code.toString(16).toUpperCase().padStart(2, "0") })));
  $("state-form").addEventListener("change", async ({ target }) => {
    const value = target.type === "checkbox" ? Number(target.checked) : Number(target.value);
    const state = await ask("set", { [target.name]: value });
    if (state) showState(state);
  });
  $("state-form").addEventListener("submit", (event) => event.preventDefault());
  $("line-form").elements.baud.append(...[1200, 2400, 4800, 9600, 19200, 38400].map((baud) => element("option", { text: baud })));
  $("line-form").addEventListener("change", () => {
    const form = $("line-form").elements;
    ask("line", { address: Number(form.address.value), baud: Number(form.baud.value), format: form.format.value });
  });
  $("line-form").addEventListener("submit", (event) => event.preventDefault());

  // ------------------------------------------------------------------ faults

  // Fields for {argument: [default, least, most, meaning]}, as FORMS has them.
  const fields = (names) => Object.entries(names).map(([name, [value, least, most, meaning]]) => {
    const number = typeof value === "number";
    const input = element(name === "csv" ? "textarea" : "input", number
      ? { type: "number", step: "any", min: least, max: most, value, name, title: meaning }
      : { name, title: meaning });
    if (!number) input.value = value;
    return element("label", { title: meaning, text: `${name} ` }, input);
  });
  const valuesOf = (box) => Object.fromEntries([...box.querySelectorAll("input,textarea")].map((i) => [i.name, i.type === "number" ? Number(i.value) : i.value]));

  $("kind").append(...Object.entries(Faults.KINDS).map(([kind, [, , meaning]]) => element("option", { value: kind, text: meaning })));
  const faultForm = () => {
    const [directions, names] = Faults.KINDS[$("kind").value];
    $("fault-values").replaceChildren(...fields(names));
    for (const option of $("direction").options) option.disabled = !directions.includes(option.value);
    if (!directions.includes($("direction").value)) $("direction").value = directions[0];
  };
  $("kind").addEventListener("change", faultForm);
  $("when").addEventListener("change", () => {
    const name = $("when").value;
    $("when-value-label").hidden = name === "once";
    $("when-value-label").firstElementChild.textContent = name === "every" ? "n" : "0 to 1";
    $("when-value").value = name === "every" ? 3 : 0.2;
  });
  $("fault-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    const given = { direction: $("direction").value, kind: $("kind").value, ...valuesOf($("fault-values")) };
    if ($("when").value !== "once") given[$("when").value] = Number($("when-value").value);
    try {
      Faults.check(given);
    } catch (error) {
      return trouble(error.message);
    }
    await ask("fault", given);
    showFaults();
  });
  const showFaults = async () => {
    const got = await ask("faults");
    if (!got) return;
    const signature = JSON.stringify(got.faults);
    if ($("active-faults").dataset.shown === signature) return;
    $("active-faults").dataset.shown = signature;
    $("active-faults").replaceChildren(...got.faults.map((fault) => {
      const when = fault.every ? `every ${fault.every}` : fault.probability !== undefined ? `with probability ${fault.probability}` : "the next frame";
      return element("li", {}, element("span", { text: `${fault.direction}: ${Faults.describe(fault)}, ${when}; done ${fault.done || 0}` }),
        element("button", { type: "button", text: "Remove", onclick: async () => { await ask("unfault", { fault: fault.fault }); showFaults(); } }));
    }));
  };
  faultForm();

  // ------------------------------------------------------------------ send

  const PRESETS = [
    ["read holding registers 0 to 9", (a) => [a, 3, 0, 0, 0, 10]],
    ["read input registers 0 to 3", (a) => [a, 4, 0, 0, 0, 4]],
    ["read coils 0 to 15", (a) => [a, 1, 0, 0, 0, 16]],
    ["write holding register 1 = 42", (a) => [a, 6, 0, 1, 0, 42]],
    ["write holding registers 0 to 2", (a) => [a, 16, 0, 0, 0, 3, 6, 0, 1, 0, 2, 0, 3]],
    ["switch coil 3 on", (a) => [a, 5, 0, 3, 255, 0]],
    ["broadcast: holding register 0 = 7", () => [0, 6, 0, 0, 0, 7]],
    ["read past the end of a table", (a) => [a, 3, 255, 255, 0, 1]],
    ["a request for another slave", (a) => [a === 247 ? 1 : a + 1, 3, 0, 0, 0, 1]],
    ["an unknown function", (a) => [a, 0x63]],
    ["return query data", (a) => [a, 8, 0, 0, 0xa5, 0x37]],
    ["get the event log", (a) => [a, 12]],
    ["force listen-only mode", (a) => [a, 8, 0, 4, 0, 0]],
    ["restart communications", (a) => [a, 8, 0, 1, 0, 0]],
    ["read device identification", (a) => [a, 0x2b, 14, 1, 0]],
  ];
  const crcOf = (bytes) => {
    let crc = 0xffff;
    for (const b of bytes) {
      crc ^= b;
      for (let i = 0; i < 8; ++i) crc = crc & 1 ? crc >> 1 ^ 0xa001 : crc >> 1;
    }
    return [crc & 255, crc >> 8];
  };
  // With its check field; in ASCII mode as characters.
  const sealed = (bytes) => {
    if (device.mode !== "ascii") return [...bytes, ...crcOf(bytes)];
    const lrc = -bytes.reduce((sum, b) => sum + b, 0) & 255;
    return [58, ...Array.from(hexText([...bytes, lrc]).replaceAll(" ", ""), (c) => c.charCodeAt(0)), 13, 10];
  };
  const hexText = (bytes) => bytes.map((b) => b.toString(16).toUpperCase().padStart(2, "0")).join(" ");
  $("preset").append(...PRESETS.map(([text], i) => element("option", { value: i, text })));
  const preset = () => { $("hex").value = hexText(PRESETS[$("preset").value][1](Number($("slave").value) || device.address || 17)); };
  $("preset").addEventListener("change", preset);
  const send = async () => {
    const text = $("hex").value.replace(/\s/g, "");
    if (!/^([0-9a-f]{2})+$/i.test(text)) return trouble("bytes: must be pairs of hexadecimal digits");
    const bytes = text.match(/../g).map((b) => parseInt(b, 16));
    const got = await ask("send", { hex: hexText($("crc").checked ? sealed(bytes) : bytes) });
    if (!got) return undefined;
    $("send-answer").replaceChildren(got.answer ? element("code", { text: `answer ${got.answer}` }) : "no answer: the frames say why");
    return tick();
  };
  $("send-form").addEventListener("submit", (event) => {
    event.preventDefault();
    send();
  });
  setInterval(() => { if ($("poll").checked && backend) send(); }, 1000);

  // ------------------------------------------------------------------ values that move

  $("signal-kind").append(...Object.keys(FORMS.signals).map((kind) => element("option", { text: kind })));
  const signalForm = () => $("signal-values").replaceChildren(...fields(FORMS.signals[$("signal-kind").value]));
  $("signal-kind").addEventListener("change", signalForm);
  signalForm();
  $("signal-form").addEventListener("submit", async (event) => {
    event.preventDefault();
    await ask("attach", { point: $("signal-point").value.trim(), kind: $("signal-kind").value, ...valuesOf($("signal-values")) });
    showSignals();
  });
  const showSignals = async () => {
    const got = await ask("signals");
    if (!got) return;
    const list = got.signals.map((signal) => element("li", {}, element("span", { text: `${signal.point}: ${signal.text}` }),
      element("button", { type: "button", text: "Remove", onclick: async () => { await ask("detach", { point: signal.point }); showSignals(); } })));
    if (got.script) {
      list.push(element("li", { class: got.script.error ? "error" : "" },
        element("span", { text: `script ${got.script.file}: ${got.script.error || `${got.script.calls} calls`}` })));
    }
    $("signals-list").replaceChildren(...list);
  };

  // ------------------------------------------------------------------ the whole

  const showDevice = (got) => {
    device = got;
    $("title").textContent = device.name || "modbus_rtu_slave";
    document.title = `${device.address} · ${device.name || "modbus_rtu_slave"}`;
    const several = (device.slaves || []).length > 1;
    const mode = device.mode === "ascii" ? " ASCII" : "";
    $("summary").textContent = `${several ? "" : `slave ${device.address} · `}${device.baud} baud ${device.format}${mode}`;
    $("slave-label").hidden = !several;
    if (several && $("slave").options.length !== device.slaves.length)
      $("slave").replaceChildren(...device.slaves.map((address) => element("option", { text: address })));
    const { send: sends, line, signals, capture } = device.features;
    $("state-form").hidden = !inputs().length;
    for (const field of $("state-form").elements) field.closest("label").hidden = !inputs().includes(field.name);
    $("send").hidden = !sends;
    $("line-form").hidden = !line;
    $("values").hidden = !signals;
    document.body.classList.toggle("alone", line);          // the core in the page: it is the visitor who sends
    $("downloads").replaceChildren(...(capture ? ["pcapng", "fst", "txt"] : []).flatMap((kind, i) =>
      [i ? " " : "save as ", element("a", { href: `api/capture.${kind}`, download: "", text: kind })]));
    $("points").replaceChildren(...(device.points || []).map((point) => element("option", { value: point.name })));
    for (const field of $("line-form").elements) if (field.name in device) field.value = device[field.name];
    buildTabs();
    preset();
  };

  let ticking = false;
  const tick = async () => {
    if (ticking || !connected) return;
    ticking = true;
    try {
      const status = await ask("status");
      if (status) showStatus(status);
      const state = await ask("state");
      if (state) showState(state);
      await showFaults();
      if (device.features.signals) await showSignals();
      await refresh();
    } finally {
      ticking = false;
    }
  };

  $("slave").addEventListener("change", () => {
    preset();
    buildCells();
    tick();
  });

  const onEvent = (event) => {
    if (["frame", "silence", "delivered"].includes(event.event)) later(event);
    else if (event.event === "device") showDevice(event.device);
    else if (event.event === "write" || event.event === "changed") {
      if (event.table === table || table === "points") refresh();
    } else if (event.event === "warning") trouble(event.text);
    else if (event.event === "connection") {
      connected = event.open;
      showLights();
      trouble(event.open ? "" : "The device does not answer. The page tries again.");
      if (event.open) start();
    }
  };

  const start = async () => {
    const got = await ask("device");
    if (!got) return;
    showDevice(got);
    rows.clear();
    $("list").replaceChildren();
    const kept = await ask("frames", { limit: 200 });
    if (kept) kept.frames.forEach((frame) => later({ event: "frame", frame }));
    await tick();
  };

  document.querySelector("nav").append(...[...document.querySelectorAll("section")].map((s) =>
    element("a", { href: `#${s.id}`, text: s.querySelector("h2").textContent.replace(/ and.*| as.*| the.*/, "") })));
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches("input, select, textarea")) return;
    if (event.key === "?") $("keys").showModal();
    if (event.key === "p") pause();
    const part = [...document.querySelectorAll("section:not([hidden])")].find((s) => s.dataset.key === event.key);
    if (!part) return;
    part.scrollIntoView();
    const into = part.querySelector("#list, canvas, [role=gridcell][tabindex='0']") || part.querySelector("select, input, button");
    if (into) into.focus();
    event.preventDefault();
  });
  $("help").addEventListener("click", () => $("keys").showModal());

  const remembered = (name, value) => {           // a page from disk may have no storage
    try {
      if (value !== undefined) localStorage.setItem(name, value);
      return localStorage.getItem(name);
    } catch {
      return null;
    }
  };
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const theme = (name) => {
    document.documentElement.dataset.theme = name || (dark.matches ? "dark" : "light");
    Wave.draw();
  };
  dark.addEventListener("change", () => theme(remembered("theme")));
  $("theme").addEventListener("click", () => {
    const next = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    remembered("theme", next);
    theme(next);
  });
  theme(remembered("theme"));

  // Takes a back end that says it is connected by an event {event: "connection", open}.
  const use = (made) => {
    backend = made;
    backend.onEvent(onEvent);
    setInterval(tick, POLL_MS);
  };
  return { use, ask, send, get backend() { return backend; } };
})();
