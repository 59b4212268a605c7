// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// faults - what can be broken on the line: the kinds, their arguments and what each means, for the form of the panel.
"use strict";

const Faults = (() => {
  const CHARACTER = { character: [0, -256, 255, "character, from 0; negative from the end"] };
  // kind: [meaning, {argument: [default, least, most, meaning]}, directions]
  const KINDS = {
    wrong_crc: ["wrong CRC", {}, ["request", "answer"]],
    flip: ["a flipped data bit", { ...CHARACTER, bit: [0, 0, 7, "data bit"] }, ["request", "answer"]],
    parity: ["wrong parity", CHARACTER, ["request", "answer"]],
    stop: ["a stop bit that is low", CHARACTER, ["request", "answer"]],
    break: ["a break before a character", { ...CHARACTER, bits: [12, 1, 1000, "bit times low"] }, ["request", "answer"]],
    glitch: ["a glitch before a start bit", { ...CHARACTER, width: [0.3, 0.07, 0.49, "bit times low"] }, ["request", "answer"]],
    jitter: ["jitter of every edge", { amount: [0.2, 0, 0.45, "bit times at most"] }, ["request", "answer"]],
    rate: ["the rate is off", { amount: [3, -20, 20, "per cent"] }, ["request", "answer"]],
    gap: ["a gap before a character", { character: [1, -256, 255, "character, from 0; negative from the end"],
      amount: [2, 0, 1000, "characters long"] }, ["request", "answer"]],
    cut: ["a cut frame", { character: [4, -256, 255, "bytes that remain"] }, ["request", "answer"]],
    extra: ["a byte too many", { value: [0, 0, 255, "its value"] }, ["request", "answer"]],
    swapped_crc: ["CRC bytes swapped", {}, ["request", "answer"]],
    none: ["the frame is lost", {}, ["request", "answer"]],
    late: ["a late answer", { amount: [100, 0, 60000, "milliseconds"] }, ["answer"]],
    echo: ["an echo", {}, ["request", "answer"]],
    collision: ["another talker over the frame", { ...CHARACTER, value: [85, 0, 255, "its characters"] }, ["request", "answer"]],
  };
  const WHEN = { every: [1, 1e9], probability: [0, 1], count: [1, 1e9] };

  // A fault with all its arguments; throws `Refused` with a text.
  const check = (given, Refused = Error) => {
    const { direction = "request", kind, ...rest } = given;
    if (!(kind in KINDS)) throw new Refused(`kind: must be ${Object.keys(KINDS).join(", ")}`);
    const [, names, directions] = KINDS[kind];
    if (!directions.includes(direction)) throw new Refused(`direction: ${kind} can be in ${directions.join(" or ")}`);
    const out = { direction, kind };
    for (const [name, [value]] of Object.entries(names)) out[name] = value;
    for (const [name, value] of Object.entries(rest)) {
      const limits = names[name] ? names[name].slice(1, 3) : WHEN[name];
      if (!limits) throw new Refused(`${name}: ${kind} has no such argument`);
      if (typeof value !== "number" || !(value >= limits[0] && value <= limits[1]))
        throw new Refused(`${name}: must be a number from ${limits[0]} to ${limits[1]}`);
      out[name] = value;
    }
    return out;
  };

  const describe = (fault) => {
    const f = fault;
    switch (f.kind) {
      case "flip": return `bit ${f.bit} of character ${f.character} flipped`;
      case "parity": return `wrong parity of character ${f.character}`;
      case "stop": return `low stop bit of character ${f.character}`;
      case "break": return `break of ${f.bits} bits before character ${f.character}`;
      case "glitch": return `glitch of ${f.width} bits before character ${f.character}`;
      case "jitter": return `edges jitter by ${f.amount} bits`;
      case "rate": return `rate off by ${f.amount} %`;
      case "gap": return `gap of ${f.amount} characters before character ${f.character}`;
      case "cut": return `cut to ${f.character} bytes`;
      case "extra": return `byte ${f.value} too many`;
      case "late": return `${f.amount} ms late`;
      case "collision": return `collision from character ${f.character} on`;
      default: return KINDS[f.kind] ? KINDS[f.kind][0] : f.kind;
    }
  };

  // "gap character 1 amount 2", as the device writes a fault, in words.
  const inWords = (text) => text.split("; ").map((one) => {
    const [kind, ...rest] = one.split(" ");
    if (!(kind in KINDS)) return one;
    const fault = { kind };
    for (const [name, [value]] of Object.entries(KINDS[kind][1])) fault[name] = value;
    for (let i = 0; i + 1 < rest.length; i += 2) fault[rest[i]] = rest[i + 1];
    return describe(fault);
  }).join("; ");

  // As the device writes it.
  const written = (fault) => [fault.kind, ...Object.keys(KINDS[fault.kind][1]).flatMap((name) => [name, fault[name]])].join(" ");

  return { KINDS, WHEN, check, describe, inWords, written };
})();
if (typeof module !== "undefined") module.exports = Faults;
