// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// faults - what can be broken on the line, for the form of the panel. FORMS comes from sim/server/forms.py.
"use strict";

const Faults = (() => {
  const KINDS = FORMS.faults; // kind: [directions, {key: [value, least, most, meaning, whole]}, meaning]
  const WHEN = FORMS.when;
  const defaults = (kind) => Object.fromEntries(Object.entries(KINDS[kind][1]).map(([name, [value]]) => [name, value]));

  // A fault with all its arguments; throws `Refused` with a text.
  const check = (given, Refused = Error) => {
    const { direction = "request", kind, ...rest } = given;
    if (!(kind in KINDS)) throw new Refused(`kind: must be ${Object.keys(KINDS).join(", ")}`);
    const [directions, keys] = KINDS[kind];
    if (!directions.includes(direction)) throw new Refused(`direction: ${kind} can be in ${directions.join(" or ")}`);
    const out = { direction, kind, ...defaults(kind) };
    for (const [name, value] of Object.entries(rest)) {
      if (!keys[name] && !WHEN[name]) throw new Refused(`${name}: ${kind} has no such argument`);
      const [, least, most, , whole] = keys[name] || WHEN[name];
      if (typeof value !== "number" || !(value >= least && value <= most) || (whole && !Number.isInteger(value)))
        throw new Refused(`${name}: must be a ${whole ? "whole " : ""}number from ${least} to ${most}`);
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
      default: return KINDS[f.kind] ? KINDS[f.kind][2] : f.kind;
    }
  };

  // "gap character 1 amount 2", as the device writes a fault, in words.
  const inWords = (text) => text.split("; ").map((one) => {
    const [kind, ...rest] = one.split(" ");
    if (!(kind in KINDS)) return one;
    const fault = { kind, ...defaults(kind) };
    for (let i = 0; i + 1 < rest.length; i += 2) fault[rest[i]] = rest[i + 1];
    return describe(fault);
  }).join("; ");

  // As the device writes it.
  const written = (fault) => [fault.kind, ...Object.keys(KINDS[fault.kind][1]).flatMap((name) => [name, fault[name]])].join(" ");

  return { KINDS, WHEN, check, describe, inWords, written };
})();
if (typeof module !== "undefined") module.exports = Faults;
