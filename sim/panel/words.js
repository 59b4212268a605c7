// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// words - RTU frames in words, for a page without a server: the same texts as tb/protocol/words.py, which a test compares.
"use strict";

const Words = (() => {
  const NAMES = {
    1: "read coils", 2: "read discrete inputs", 3: "read holding registers", 4: "read input registers",
    5: "write single coil", 6: "write single register", 7: "read exception status", 8: "diagnostics",
    0x0b: "get comm event counter", 0x0c: "get comm event log", 0x0f: "write multiple coils",
    0x10: "write multiple registers", 0x11: "report slave ID", 0x14: "read file record", 0x15: "write file record",
    0x16: "mask write register", 0x17: "read/write multiple registers", 0x18: "read FIFO queue",
    0x2b: "read device identification",
  };
  const EXCEPTIONS = {
    1: "illegal function", 2: "illegal data address", 3: "illegal data value", 4: "slave device failure", 5: "acknowledge",
    6: "slave device busy", 7: "negative acknowledge", 8: "memory parity error", 10: "gateway path unavailable",
    11: "gateway target failed to respond",
  };
  const ITEMS = { 1: ["coil", "coils"], 2: ["discrete input", "discrete inputs"], 4: ["input register", "input registers"] };
  const HOLDING = ["holding register", "holding registers"];
  const COUNTERS = {
    0x0b: "bus messages", 0x0c: "communication errors", 0x0d: "exceptions", 0x0e: "messages for this slave",
    0x0f: "not answered", 0x10: "NAKs", 0x11: "busy answers", 0x12: "overruns",
  };
  const SUBS = {
    0: "return query data", 1: "restart communications", 2: "return the diagnostic register",
    3: "change the ASCII input delimiter", 4: "force listen-only mode", 10: "clear counters and diagnostic register",
    0x14: "clear overrun counter and flag",
  };
  for (const sub in COUNTERS) SUBS[sub] = `return the count of ${COUNTERS[sub]}`;
  const OBJECTS = ["VendorName", "ProductCode", "MajorMinorRevision", "VendorUrl", "ProductName", "ModelName",
    "UserApplicationName"];
  const CATEGORIES = ["", "basic", "regular", "extended", "one object"];
  const SHOWN = 12;

  class Misfit extends Error {}

  const hex = (value, digits = 2) => value.toString(16).toUpperCase().padStart(digits, "0");
  const text = (bytes) => Array.from(bytes, (b) => hex(b)).join(" ");
  const word = (bytes, at) => {
    if (at + 2 > bytes.length) throw new Misfit();
    return bytes[at] << 8 | bytes[at + 1];
  };
  // Exactly so many big-endian words from `at` to the end.
  const exactly = (bytes, at, count) => {
    if (bytes.length - at !== 2 * count) throw new Misfit();
    return Array.from({ length: count }, (_, i) => word(bytes, at + 2 * i));
  };
  const byte = (bytes, at) => {
    if (at >= bytes.length) throw new Misfit();
    return bytes[at];
  };
  const words = (bytes) => {
    if (bytes.length % 2) throw new Misfit();
    return Array.from({ length: bytes.length / 2 }, (_, i) => word(bytes, 2 * i));
  };
  const unpackBits = (bytes, count) => {
    if (bytes.length * 8 < count) throw new Misfit();
    return Array.from({ length: count }, (_, i) => bytes[i >> 3] >> (i & 7) & 1);
  };

  const crc16 = (bytes) => {
    let crc = 0xffff;
    for (const b of bytes) {
      crc ^= b;
      for (let i = 0; i < 8; ++i) crc = crc & 1 ? crc >> 1 ^ 0xa001 : crc >> 1;
    }
    return crc;
  };
  const sealed = (bytes) => {
    const crc = crc16(bytes);
    return [...bytes, crc & 255, crc >> 8];
  };

  const span = (items, first, count) =>
    count === 1 ? `${items[0]} ${first}` : `${items[1]} ${first} to ${first + count - 1}`;
  const values = (list) => (list.length > SHOWN ? [...list.slice(0, SHOWN - 2), "...", list[list.length - 1]] : list).join(", ");
  const bits = (list) => (list.join("").match(/.{1,8}/g) || []).join(" ");
  const name = (code) => NAMES[code] || "function unknown";
  const items = (code) => ITEMS[code === 5 || code === 15 ? 1 : code] || HOLDING;

  const broken = (frame) => {
    if (frame.length < 4) return `${frame.length} bytes are no frame`;
    if (frame.length > 256) return `${frame.length} bytes are more than a frame can have`;
    if (crc16(frame)) {
      const should = crc16(frame.slice(0, -2));
      return `CRC ${text(frame.slice(-2))} is wrong, ${text([should & 255, should >> 8])} would be right: no slave may act on it`;
    }
    return null;
  };

  const records = (file, first, quantity) =>
    `file ${file} record${quantity === 1 ? "" : "s"} ${first}` + (quantity > 1 ? ` to ${first + quantity - 1}` : "");
  const groups = (pdu) => {
    const found = [];
    for (let at = 2; at < pdu.length;) {
      if (at + 7 > pdu.length) throw new Misfit();
      const [file, first, quantity] = [word(pdu, at + 1), word(pdu, at + 3), word(pdu, at + 5)];
      at += 7;
      if (pdu[0] === 0x15) {
        found.push([file, first, words(pdu.slice(at, at + 2 * quantity))]);
        at += 2 * quantity;
      } else {
        found.push([file, first, quantity]);
      }
    }
    return found;
  };

  const diagnostics = (pdu) => {
    const [sub, data] = [word(pdu, 1), word(pdu, 3)];
    const said = SUBS[sub] || `sub-function ${hex(sub, 4)}`;
    if (sub === 1) return `${said}, ${data === 0xff00 ? "empty" : "keep"} the event log`;
    if (sub === 3) return `${said} to ${quoted(String.fromCharCode(data >> 8))}`;
    return `diagnostics, ${said}` + (!SUBS[sub] || data ? ` ${text(pdu.slice(3))}` : "");
  };
  // As Python quotes a character.
  const quoted = (s) => {
    const named = { "\n": "\\n", "\r": "\\r", "\t": "\\t", "\\": "\\\\" };
    const inner = Array.from(s, (c) => {
      const code = c.charCodeAt(0);
      if (named[c]) return named[c];
      return code < 32 || (code >= 127 && code <= 160) || code === 173 ? `\\x${hex(code).toLowerCase()}` : c;
    }).join("");
    return s.includes("'") && !s.includes('"') ? `"${inner}"` : `'${inner.replaceAll("'", "\\'")}'`;
  };
  const identify = (pdu) => {
    if (pdu.length !== 4 || pdu[1] !== 14) return `encapsulated interface, type ${hex(byte(pdu, 1))}`;
    const [code, first] = [pdu[2], pdu[3]];
    return `read device identification, ${code < 5 ? CATEGORIES[code] : `code ${hex(code)}`}` +
      (code !== 4 ? `, from ${object(first)} on` : "");
  };
  const object = (number) => OBJECTS[number] || `object ${hex(number)}`;

  const requestPdu = (pdu) => {
    const code = pdu[0];
    try {
      switch (code) {
        case 1: case 2: case 3: case 4: return `read ${span(items(code), ...exactly(pdu, 1, 2))}`;
        case 5: {
          const [address, value] = exactly(pdu, 1, 2);
          const state = { 0xff00: "on", 0: "off" }[value] || `to ${hex(value, 4)}, which is neither on nor off`;
          return `switch ${span(items(5), address, 1)} ${state}`;
        }
        case 6: {
          const [address, value] = exactly(pdu, 1, 2);
          return `write ${span(HOLDING, address, 1)} = ${value}`;
        }
        case 7: return "read exception status";
        case 8: return diagnostics(pdu);
        case 0x0b: return "get the event counter";
        case 0x0c: return "get the event log";
        case 0x0f: {
          const [address, quantity] = [word(pdu, 1), word(pdu, 3)];
          byte(pdu, 5);
          return `write ${span(items(15), address, quantity)} = ${bits(unpackBits(pdu.slice(6), quantity))}`;
        }
        case 0x10: {
          const [address, quantity] = [word(pdu, 1), word(pdu, 3)];
          byte(pdu, 5);
          return `write ${span(HOLDING, address, quantity)} = ${values(words(pdu.slice(6)))}`;
        }
        case 0x11: return "report server ID";
        case 0x14: return "read " + groups(pdu).map((g) => records(...g)).join("; ");
        case 0x15: return "write " + groups(pdu).map(([f, r, v]) => `${records(f, r, v.length)} = ${v.join(", ")}`).join("; ");
        case 0x16: {
          const [address, ands, ors] = exactly(pdu, 1, 3);
          return `mask ${span(HOLDING, address, 1)}: AND ${hex(ands, 4)}, OR ${hex(ors, 4)}`;
        }
        case 0x17: {
          const [read, count, write, quantity] = [1, 3, 5, 7].map((at) => word(pdu, at));
          byte(pdu, 9);
          return `write ${span(HOLDING, write, quantity)} = ${values(words(pdu.slice(10)))}, then read ${span(HOLDING, read, count)}`;
        }
        case 0x18: {
          return `read FIFO queue at holding register ${exactly(pdu, 1, 1)[0]}`;
        }
        case 0x2b: return identify(pdu);
      }
    } catch (error) {
      if (!(error instanceof Misfit)) throw error;
      return `${name(code)}, but the length does not fit`;
    }
    return `${name(code)} (function ${hex(code)})`;
  };

  const request = (frame) =>
    broken(frame) || `to ${frame[0] ? `slave ${frame[0]}` : "all slaves"}: ${requestPdu(frame.slice(1, -2))}`;

  // ------------------------------------------------------------------ the event log

  const received = (event) => {
    const what = event & 2 ? (event & 16 ? "frame too long" : "bad frame")
      : event & 64 ? "broadcast received" : "received";
    return what + (event & 32 ? " while listening only" : "");
  };
  const sent = (event, answerless) => {
    if (event & 32) return "kept silent";
    for (const [bit, what] of [[1, "refused"], [2, "failed"], [4, "put off as busy"], [8, "refused with NAK"]])
      if (event & bit) return what;
    return answerless ? "no answer due" : "answered";
  };
  // The log (newest entry first) as texts, oldest message first.
  const messages = (log) => {
    const events = [...log].reverse(), out = [];
    events.forEach((event, place) => {
      if (event & 128) {
        out.push(`${hex(event)} ${received(event)}`);
      } else if (event & 64) {
        const before = place ? events[place - 1] : 128;
        const said = `${hex(event)} ${sent(event, before & 64 || events[place + 1] === 4)}`;
        if (place && before & 128) out.push(`${out.pop()}, ${said}`);
        else out.push(said);
      } else {
        out.push(`${hex(event)} ${{ 4: "listens only from now on", 0: "communication restarted" }[event] || "is no event"}`);
      }
    });
    return out;
  };
  const story = (log) => {
    const runs = [];
    for (const what of messages(log)) {
      if (runs.length && runs[runs.length - 1][0] === what) ++runs[runs.length - 1][1];
      else runs.push([what, 1]);
    }
    return runs.map(([what, n]) => (n > 1 ? `${n} x (${what})` : what)).join("; ") || "empty";
  };
  const register = (value) => {
    if (!value) return "0000, nothing set";
    const set = [];
    for (let i = 15; i > 0; --i) if (value >> i & 1) set.push(i);
    const said = set.length ? [`bit${set.length > 1 ? "s" : ""} ${set.join(" ")} of the host`] : [];
    if (value & 1) said.push("overrun flag");
    return `${hex(value, 4)}, ${said.join(" and ")}`;
  };
  const status = (value) => (value === 0xffff ? "busy" : value ? `status ${hex(value, 4)}` : "ready");

  // ------------------------------------------------------------------ answers

  const same = (a, b) => a.length === b.length && a.every((x, i) => x === b[i]);

  const answerPdu = (asked, pdu) => {
    const code = pdu[0];
    if (code === (asked[0] | 128) && pdu.length === 2)
      return `refused, exception ${hex(pdu[1])}: ${EXCEPTIONS[pdu[1]] || "unknown"}`;
    if (code !== asked[0]) return `answers another function (${hex(code)})`;
    try {
      switch (code) {
        case 1: case 2: {
          const [first, count] = exactly(asked, 1, 2);
          return `${span(items(code), first, count)} = ${bits(unpackBits(pdu.slice(2), count))}`;
        }
        case 3: case 4: case 0x17: {
          const [first, count] = [word(asked, 1), word(asked, 3)];
          byte(pdu, 1);
          return `${span(items(code), first, count)} = ${values(words(pdu.slice(2)))}`;
        }
        case 5: case 6: case 0x16: return same(pdu, asked) ? "done (the request is repeated)" : "done, but not what was asked";
        case 0x0f: case 0x10: return `done: ${span(items(code), ...exactly(pdu, 1, 2))}`;
        case 7: return `exception status ${hex(byte(pdu, 1))} = ${pdu[1].toString(2).padStart(8, "0")}`;
        case 8: {
          const [sub, data] = [word(pdu, 1), word(pdu, 3)];
          if (COUNTERS[sub]) return `${COUNTERS[sub]}: ${data}`;
          if (sub === 2) return `diagnostic register ${register(data)}`;
          return same(pdu, asked) ? "the same comes back" : "something else comes back";
        }
        case 0x0b: {
          const [state, count] = exactly(pdu, 1, 2);
          return `${status(state)}, events ${count}`;
        }
        case 0x0c: {
          const [state, count, total] = exactly(pdu.slice(0, 8), 2, 3);
          return `${status(state)}, events ${count}, bus messages ${total}; log, oldest first: ${story(pdu.slice(8))}`;
        }
        case 0x11: {
          const more = pdu.length > 4 ? `, additional data ${text(pdu.slice(4))}` : "";
          return `server ID ${hex(byte(pdu, 2))}, ${byte(pdu, 3) ? "running" : "stopped"}${more}`;
        }
        case 0x14: {
          let at = 2;
          return groups(asked).map(([file, first, quantity]) => {
            const size = byte(pdu, at), list = words(pdu.slice(at + 2, at + 1 + size));
            at += 1 + size;
            return `${records(file, first, quantity)} = ${list.join(", ")}`;
          }).join("; ");
        }
        case 0x15: return same(pdu, asked) ? "done (the request is repeated)" : "not what was asked";
        case 0x18: {
          const count = word(pdu, 3), list = words(pdu.slice(5));
          return count ? `${count} entries: ${list.join(", ")}` : "the queue is empty";
        }
        case 0x2b: {
          const objects = [];
          let at = 7;
          for (let i = byte(pdu, 6); i; --i) {
            const [number, size] = [byte(pdu, at), byte(pdu, at + 1)];
            objects.push(`${object(number)} ${quoted(String.fromCharCode(...pdu.slice(at + 2, at + 2 + size)))}`);
            at += 2 + size;
          }
          return `conformity ${hex(pdu[3])}: ${objects.join(", ")}${pdu[4] ? `; more from ${object(pdu[5])} on` : ""}`;
        }
      }
    } catch (error) {
      if (!(error instanceof Misfit)) throw error;
      return `answer to ${name(code)}, but the length does not fit`;
    }
    return `answer to ${name(code)}: ${text(pdu.slice(1))}`;
  };

  const answer = (asked, frame) => {
    if (!frame) return "silence";
    if (broken(frame)) return broken(frame);
    const said = answerPdu(asked.slice(1, -2), frame.slice(1, -2));
    return frame[0] === asked[0] ? said : `from slave ${frame[0]}, which was not asked: ${said}`;
  };

  // ------------------------------------------------------------------ silence

  const ERRORS = {
    parity: "a character with wrong parity", framing: "a character without its stop bit",
    overrun: "characters came while the core was still at work", crc: "wrong CRC", short: "fewer than 4 bytes",
    long: "more than 256 bytes", gap: "a gap above t1.5 inside the frame",
  };
  // Why a frame got no answer: what the core told of it, the address it went to, and its mode.
  const silence = (frame, errors, own, listening) => {
    if (errors.length) return errors.map((e) => ERRORS[e]).join(", ");
    if (!frame.length) return "no character was heard";
    if (frame[0] === 0) return "a broadcast, which is never answered";
    if (frame[0] !== own) return `for slave ${frame[0]}, this one is ${own}`;
    if (listening) return "the slave is in listen-only mode";
    if (frame[1] === 8 && frame[2] === 0 && frame[3] === 4) return "listen-only mode begins without an answer";
    return "the core gave no answer";
  };

  return { request, answer, requestPdu, silence, story, messages, register, crc16, sealed, text, hex, broken, COUNTERS, ERRORS };
})();
if (typeof module !== "undefined") module.exports = Words;
