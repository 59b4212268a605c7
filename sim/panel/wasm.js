// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// wasm - the back end of docs/try.html: the core in the page, the line around it, and a master that sends.
//
// Has the face of socket.js: call(op, arguments) -> promise, and events.  core.cpp knows levels and clocks only; this file
// makes levels of bytes, with a fault where one is set, and bytes of levels.
"use strict";

const Wasm = (() => {
  const CLOCK_HZ = 307200;                     // 16 clocks a bit at 19200 baud
  const ADDRESS = 17;
  const TABLES = { coils: [0, 1024], discretes: [0, 2048], inputs: [0, 1024], holdings: [0, 2048] };
  const FILES = [4, 256];
  const SPACES = { coils: 0, discretes: 1, inputs: 2, holdings: 3, files: 4 };
  const FORMATS = ["8E1", "8O1", "8N2", "8N1"];
  const STROBES = ["frame", "parity", "framing", "overrun", "crc", "short", "long", "gap"];
  const WRITE = 8;                             // bit of a strobe word
  const COUNTERS = { event: 10, bus_message: 11, comm_error: 12, exception: 13, slave_message: 14, no_response: 15, nak: 16,
    busy: 17, overrun: 18 };
  const VERDICTS = { crc: "crc", parity: "parity", framing: "framing", overrun: "overrun", gap: "gap", long: "too long",
    short: "too short" };
  const FRAMES_KEPT = 2000;
  const PATIENCE_MS = 200;                     // for the core's verdict and answer
  const CHANNEL_PIN = { rxd: 2, txd: 1 };

  class Refused extends Error {}

  // ------------------------------------------------------------------ characters

  const format = (code) => ({ parity: code < 2, odd: code === 1, stops: code === 2 ? 2 : 1,
    length: 10 + (code < 2) + (code === 2) });

  const characterBits = (data, f) => {
    const bits = [0];
    let ones = 0;
    for (let i = 0; i < 8; ++i) {
      bits.push(data >> i & 1);
      ones += data >> i & 1;
    }
    if (f.parity) bits.push((ones & 1) ^ (f.odd ? 1 : 0));
    for (let i = 0; i < f.stops; ++i) bits.push(1);
    return bits;
  };

  // Characters of a pin: [{start, data, errors}], each bit sampled at its middle.
  const characters = (edges, pin, bitTime, f) => {
    const found = [];
    let level = 1, at = 0, free = 0;
    const levelAt = (cycle) => {
      while (at < edges.length && edges[at][0] <= cycle) level = edges[at++][1] >> pin & 1;
      return level;
    };
    for (let i = 0; i < edges.length; ++i) {
      const [cycle, pins] = edges[i];
      if (cycle < free || pins >> pin & 1 || (i && !(edges[i - 1][1] >> pin & 1))) continue;
      at = i;
      const sample = (k) => levelAt(cycle + Math.floor((k + 0.5) * bitTime));
      if (sample(0)) continue;                 // a glitch
      let data = 0, ones = 0;
      for (let k = 0; k < 8; ++k) {
        const bit = sample(1 + k);
        data |= bit << k;
        ones += bit;
      }
      const errors = [];
      if (f.parity && sample(9) !== ((ones & 1) ^ (f.odd ? 1 : 0))) errors.push("parity");
      if (!sample(9 + f.parity)) errors.push("framing");
      found.push({ start: cycle, data, errors });
      free = cycle + (f.length - 0.5) * bitTime;
    }
    return found;
  };

  // ------------------------------------------------------------------ faults

  const place = (index, length) => (index < 0 ? length + index : index);

  // The bytes that a fault makes of a frame.
  const faultyBytes = (frame, fault) => {
    const f = fault || {};
    const bytes = [...frame], n = bytes.length;
    if (f.kind === "cut") return bytes.slice(0, f.character);
    if (f.kind === "extra") return [...bytes, f.value & 255];
    if (f.kind === "swapped_crc" && n > 1) [bytes[n - 2], bytes[n - 1]] = [bytes[n - 1], bytes[n - 2]];
    if (f.kind === "wrong_crc" && n) bytes[n - 1] ^= 0x55;
    if (f.kind === "none") return [];
    return bytes;
  };

  // A frame as [[level, clocks], ...] on rxd, with a fault.
  const levels = (frame, fault, bitTime, code) => {
    const f = format(code), kind = fault ? fault.kind : "", out = [];
    const bytes = faultyBytes(frame, fault);
    const hit = fault && "character" in fault ? place(fault.character, bytes.length) : -1;
    const unit = kind === "rate" ? bitTime / (1 + fault.amount / 100) : bitTime;
    const put = (level, bits) => out.push([level, bits * unit]);
    bytes.forEach((data, index) => {
      const bits = characterBits(data, f);
      if (index === hit) {
        if (kind === "gap") put(1, fault.amount * f.length);
        if (kind === "break") put(0, fault.bits);
        if (kind === "break") put(1, 1);
        if (kind === "glitch") {
          put(0, fault.width);
          put(1, 1.5 - fault.width);
        }
        if (kind === "flip") bits[1 + (fault.bit & 7)] ^= 1;
        if (kind === "parity" && f.parity) bits[9] ^= 1;
        if (kind === "stop") bits[bits.length - f.stops] = 0;
      }
      if (kind === "collision" && index >= hit) characterBits(fault.value, f).forEach((bit, k) => { bits[k] &= bit; });
      for (const bit of bits) put(bit, 1);
    });
    if (kind === "jitter") {                   // each edge moves, the sum stays
      let shift = 0;
      for (const piece of out) {
        const next = (Math.random() * 2 - 1) * fault.amount * unit;
        piece[1] += next - shift;
        shift = next;
      }
    }
    // Each boundary is rounded to a clock, so fractions add up.
    let time = 0, done = 0;
    return out.map(([level, clocks]) => {
      time += clocks;
      const whole = Math.round(time) - done;
      done += whole;
      return [level, Math.max(whole, 0)];
    });
  };

  // ------------------------------------------------------------------ the device

  class Device {
    constructor(module) {
      // The core needs nothing of its host: what the C library imports is never called.
      const imports = {};
      for (const { module: from, name } of WebAssembly.Module.imports(module))
        (imports[from] = imports[from] || {})[name] = () => { throw new Error(`${name}: not available`); };
      this.core = new WebAssembly.Instance(module, imports).exports;
      if (this.core._initialize) this.core._initialize();
      this.line = { address: ADDRESS, baud: 19200, format: 0 };
      this.state = { busy: 0, failure: 0, exception_status: 0, run_indicator: 1, write_lock: 0 };
      this.errors = Object.fromEntries(STROBES.map((s) => [s, 0]));
      this.stats = { requests: 0, answers: 0, silent: 0 };
      this.frames = [];
      this.n = 0;
      this.listeners = [];
      this.faults = [];
      this.faultNumber = 0;
      this.seen = 0;
      this.setup();
      this.core.power_up();
      this.setup();
      this.wait(50);
    }

    get bitTime() { return Math.round(CLOCK_HZ / this.line.baud); }
    get character() { return this.bitTime * format(this.line.format).length; }
    get t15() { return Math.max(1.5 * this.character, this.line.baud > 19200 ? 750e-6 * CLOCK_HZ : 0); }
    get t35() { return Math.max(3.5 * this.character, 1750e-6 * CLOCK_HZ); }

    setup(diagnostic = 0, echo = 0) {
      const s = this.state;
      this.core.setup(this.line.address, this.bitTime, this.line.format,
        s.busy | s.run_indicator << 1 | s.write_lock << 2 | echo << 4, s.failure, s.exception_status, diagnostic);
    }

    view(where, words) { return new Uint32Array(this.core.memory.buffer, where, words); }

    // Plays runs; {edges, events} of it.
    play(runs) {
      const limit = this.core.run_limit(), edges = [], events = [];
      for (let from = 0; from < runs.length; from += limit) {
        const part = runs.slice(from, from + limit);
        this.view(this.core.runs_at(), 2 * part.length).set(part.flat());
        this.core.run(part.length);
        const changes = this.view(this.core.changes_at(), 2 * this.core.change_total());
        for (let i = 0; i < changes.length; i += 2) edges.push([changes[i], changes[i + 1]]);
        const told = this.view(this.core.events_at(), 4 * this.core.event_total());
        for (let i = 0; i < told.length; i += 4) events.push(told.slice(i, i + 4));
      }
      return { edges, events };
    }

    wait(ms) { return this.play([[1, Math.ceil(ms * CLOCK_HZ / 1000)]]); }

    host(space, item, write, value) {
      const got = this.core.host(space << 16 | item, write ? 1 : 0, value);
      if (got < 0) throw new Refused(`space ${space} item ${item}: no such item`);
      return got;
    }

    tell(event) { for (const listener of this.listeners) listener(event); }

    // The fault of the next frame in a direction, or undefined.
    fault(direction) {
      for (const fault of this.faults) {
        if (fault.direction !== direction) continue;
        fault.waited = (fault.waited || 0) + 1;
        if (fault.every && fault.waited % fault.every) continue;
        if (fault.probability !== undefined && Math.random() >= fault.probability) continue;
        ++fault.done;
        const repeats = fault.every || fault.probability !== undefined;
        if (!repeats || (fault.count && fault.done >= fault.count)) this.faults.splice(this.faults.indexOf(fault), 1);
        return fault;
      }
      return undefined;
    }

    // A master's frame: what comes back, or [] for silence.
    send(bytes) {
      const fault = this.fault("request"), answerFault = this.fault("answer");
      const code = this.line.format, f = format(code), listening = this.core.status(1) & 1;
      this.setup(0, answerFault && answerFault.kind === "echo" ? 1 : 0);
      const from = this.core.now();
      const lead = [[1, Math.ceil(this.t35) + 2 * this.bitTime]];
      const all = this.play([...lead, ...levels(bytes, fault, this.bitTime, code)]);
      const end = this.core.now(), limit = end + PATIENCE_MS * CLOCK_HZ / 1000;
      const started = () => all.edges.some(([, pins]) => pins & 1);
      let judged = 0;
      while (this.core.now() < limit) {
        const more = this.play([[1, this.character]]);
        all.edges.push(...more.edges);
        all.events.push(...more.events);
        if (!judged && all.events.some((e) => e[1] & 255)) judged = this.core.now();
        if (started() && this.core.at_rest()) break;
        if (judged && this.core.at_rest() && this.core.now() > judged + 30e-3 * CLOCK_HZ) break;
        if (!judged && this.core.now() > end + this.t35 + 20e-3 * CLOCK_HZ) break;
      }
      this.setup();
      const edges = all.edges.filter(([cycle, pins], i, list) => !i || pins !== list[i - 1][1]);
      const start = from + lead[0][1];
      return this.report(bytes, fault, answerFault, edges, all.events, { start, end, listening, f });
    }

    report(sent, fault, answerFault, edges, events, { start, end, listening, f }) {
      const errors = [];
      for (const [, strobes] of events)
        STROBES.forEach((name, bit) => {
          if (!(strobes >> bit & 1)) return;
          ++this.errors[name];
          if (bit && !errors.includes(name)) errors.push(name);
        });
      const heard = characters(edges, CHANNEL_PIN.rxd, this.bitTime, f).filter((c) => c.start <= end);
      const said = characters(edges, CHANNEL_PIN.txd, this.bitTime, f);
      const bytes = heard.map((c) => c.data);
      const time = Date.now() / 1000;
      const request = {
        n: ++this.n, time, direction: "request", hex: Words.text(bytes), words: Words.request(bytes), errors,
        injected: fault ? Faults.written(fault) : "", start, end, edges, characters: heard,
      };
      ++this.stats.requests;
      this.keep(request);
      this.tell({ event: "frame", frame: this.row(request) });
      for (const [, strobes, spaceFirst, fileLast] of events)
        if (strobes >> WRITE & 1) this.tellWrite(spaceFirst, fileLast, request.n);
      if (!said.length) {
        ++this.stats.silent;
        const verdict = this.verdict(bytes, errors, listening);
        this.tell({ event: "silence", to: request.n, verdict, words: Words.silence(bytes, errors, this.line.address, listening) });
        return [];
      }
      const reply = said.map((c) => c.data);
      ++this.stats.answers;
      const answer = {
        n: ++this.n, time: time + (said[0].start - start) / CLOCK_HZ, direction: "answer", hex: Words.text(reply),
        words: Words.answer(bytes, reply), exception: reply.length > 2 && reply[1] > 127, errors: [], injected: answerFault ? Faults.written(answerFault) : "",
        start: said[0].start, end: said[said.length - 1].start + this.character, edges: [], characters: said, to: request.n,
      };
      this.keep(answer);
      this.tell({ event: "frame", frame: this.row(answer) });
      let got = faultyBytes(reply, answerFault);
      if (answerFault && answerFault.kind === "flip" && got.length)
        got[place(answerFault.character, got.length)] ^= 1 << (answerFault.bit & 7);
      if (answerFault && answerFault.kind !== "echo" && Words.text(got) !== answer.hex)
        this.tell({ event: "delivered", to: answer.n, hex: Words.text(got), words: Words.answer(bytes, got.length ? got : null),
          injected: answer.injected });
      return got;
    }

    verdict(bytes, errors, listening) {
      if (errors.length) return VERDICTS[errors[0]];
      if (!bytes.length) return "not heard";
      if (bytes[0] === 0) return "broadcast";
      if (bytes[0] !== this.line.address) return "other address";
      return listening ? "listen-only" : "no answer";
    }

    tellWrite(spaceFirst, fileLast, to) {
      const space = spaceFirst >>> 16, first = spaceFirst & 0xffff, last = fileLast & 0xffff;
      const table = Object.keys(SPACES).find((name) => SPACES[name] === space);
      const values = [];
      for (let item = first; item <= last; ++item) values.push(this.core.host(space << 16 | item, 0, 0));
      this.tell({ event: "write", table, first, values, to, time: Date.now() / 1000 });
    }

    keep(frame) {
      this.frames.push(frame);
      if (this.frames.length > FRAMES_KEPT) this.frames.shift();
    }

    row({ edges, characters: unused, ...rest }) { return rest; }
  }

  // ------------------------------------------------------------------ the operations, as the server has them

  const integer = (value, least, most, name) => {
    if (!Number.isInteger(value) || value < least || value > most)
      throw new Refused(`${name}: must be a whole number from ${least} to ${most}`);
    return value;
  };

  const range = (table, first, count) => {
    if (table === "files") {
      integer(first, 0, FILES[0] * FILES[1] - 1, "first");
      integer(count, 1, FILES[0] * FILES[1] - first, "count");
      return SPACES.files;
    }
    if (!(table in TABLES)) throw new Refused(`table: must be ${Object.keys(TABLES).join(", ")} or files`);
    const [base, size] = TABLES[table];
    integer(first, base, base + size - 1, "first");
    integer(count, 1, base + size - first, "count");
    return SPACES[table];
  };

  const OPS = {
    read: (d, { table, first, count = 1 }) => {
      const space = range(table, first, count);
      return { values: Array.from({ length: count }, (_, i) => d.host(space, first + i)) };
    },
    write: (d, { table, first, values }) => {
      if (!Array.isArray(values) || !values.length) throw new Refused("values: must be a list of numbers");
      const space = range(table, first, values.length), most = space < 2 ? 1 : 65535;
      values.forEach((v) => integer(v, 0, most, "values"));
      values.forEach((v, i) => d.host(space, first + i, true, v));
      d.tell({ event: "changed", table, first, values });
      return { written: values.length };
    },
    state: (d) => ({ ...d.state, listen_only: d.core.status(1) & 1 }),
    set: (d, changes) => {
      const most = { busy: 1, failure: 15, exception_status: 255, run_indicator: 1, write_lock: 1, diagnostic: 65534 };
      for (const [name, value] of Object.entries(changes)) {
        if (!(name in most)) throw new Refused(`${name}: must be ${Object.keys(most).join(", ")}`);
        integer(value, 0, most[name], name);
      }
      const { diagnostic = 0, ...rest } = changes;
      Object.assign(d.state, rest);
      d.setup(diagnostic);
      d.wait(0.1);
      d.setup();
      return OPS.state(d);
    },
    status: (d) => {
      const entries = d.core.status(2), log = Array.from({ length: entries }, (_, i) => d.core.status(64 + i));
      const register = d.core.status(0);
      return {
        counters: Object.fromEntries(Object.entries(COUNTERS).map(([name, at]) => [name, d.core.status(at)])),
        register, register_words: Words.register(register), listen_only: d.core.status(1) & 1, log,
        story: Words.messages(log), errors: { ...d.errors }, stats: { ...d.stats },
      };
    },
    line: (d, { address = d.line.address, baud = d.line.baud, format: name = FORMATS[d.line.format] }) => {
      integer(address, 1, 247, "address");
      integer(baud, 300, 38400, "baud");
      if (!FORMATS.includes(name)) throw new Refused(`format: must be ${FORMATS.join(", ")}`);
      d.line = { address, baud, format: FORMATS.indexOf(name) };
      d.setup();
      d.wait(Math.ceil(4000 * d.t35 / CLOCK_HZ / 2));
      d.tell({ event: "device", device: OPS.device(d) });
      return {};
    },
    device: (d) => ({
      name: "modbus_rtu_slave in this page", device: "standard", link: "", address: d.line.address, baud: d.line.baud, format: FORMATS[d.line.format],
      clock_hz: CLOCK_HZ, bit_time: d.bitTime, t15: d.t15, t35: d.t35, tables: TABLES, files: FILES, points: [],
      features: { send: true, line: true, signals: false, capture: false, state: [...Object.keys(d.state), "diagnostic"] },
    }),
    frames: (d, { after = 0, limit = 200 }) => ({
      frames: d.frames.filter((f) => f.n > after).slice(-limit).map((f) => d.row(f)),
    }),
    pins: (d, { n }) => {
      const found = d.frames.find((f) => f.n === n);
      if (!found) throw new Refused(`frame ${n}: not kept`);
      const request = found.to ? d.frames.find((f) => f.n === found.to) : found;
      if (!request) throw new Refused(`frame ${n}: its request is no longer kept`);
      const answer = d.frames.find((f) => f.to === request.n);
      const list = (frame, pin) => (frame ? frame.characters : []).map((c) => ({ pin, ...c }));
      return {
        n: request.n, edges: request.edges, start: request.start, end: request.end,
        characters: [...list(request, "rxd"), ...list(answer, "txd")], clock_hz: CLOCK_HZ, bit_time: d.bitTime,
        length: format(d.line.format).length, format: FORMATS[d.line.format], t15: d.t15, t35: d.t35,
      };
    },
    fault: (d, given) => {
      const fault = Faults.check(given, Refused);
      fault.fault = ++d.faultNumber;
      fault.done = 0;
      d.faults.push(fault);
      return { fault: fault.fault };
    },
    faults: (d) => ({ faults: d.faults }),
    unfault: (d, { fault }) => {
      d.faults = fault === "all" ? [] : d.faults.filter((f) => f.fault !== fault);
      return {};
    },
    send: (d, { hex }) => {
      if (typeof hex !== "string" || !/^([0-9a-fA-F]{2}\s*){1,300}$/.test(hex.trim()))
        throw new Refused("hex: must be 1 to 300 bytes in hexadecimal");
      const bytes = hex.replace(/\s/g, "").match(/../g).map((b) => parseInt(b, 16));
      return { answer: Words.text(d.send(bytes)) };
    },
    reset: (d) => {
      d.core.power_up();
      d.setup();
      d.wait(50);
      return {};
    },
  };

  // A back end over the bytes of core.wasm.
  const open = async (bytes) => {
    const device = new Device(await WebAssembly.compile(bytes));
    return {
      device,
      onEvent: (listener) => device.listeners.push(listener),
      call: async (op, given = {}) => {
        if (!(op in OPS)) throw new Refused(`${op}: no such operation`);
        return OPS[op](device, given);
      },
    };
  };

  return { open, characters, levels, format };
})();
if (typeof module !== "undefined") module.exports = Wasm;
