// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// The faults on the wire: the one table of their kinds. faults.h includes it, faults.py reads it, and the panel gets it
// from there; what a kind does to a frame is in faults.h. The order is that of the panel's menu.
//
//   KIND(name, direction: BOTH or ANSWER, "meaning", its keys)
//   KEY(name, value if not given, least, most, WHOLE or REAL, "meaning")
//   WHEN(name, least, most, WHOLE or REAL, "meaning")   which frames, for every kind; no value if not given

#define CHARACTER(value) KEY(character, value, -256, 255, WHOLE, "character, from 0; negative from the end")

KIND(wrong_crc, BOTH, "wrong CRC", )
KIND(flip, BOTH, "a flipped data bit", CHARACTER(0) KEY(bit, 0, 0, 7, WHOLE, "data bit"))
KIND(parity, BOTH, "wrong parity", CHARACTER(0))
KIND(stop, BOTH, "a stop bit that is low", CHARACTER(0))
KIND(break, BOTH, "a break before a character", CHARACTER(0) KEY(bits, 12, 1, 1000, REAL, "bit times low"))
KIND(glitch, BOTH, "a glitch before a start bit", CHARACTER(0) KEY(width, 0.3, 0.07, 0.49, REAL, "bit times low"))
KIND(jitter, BOTH, "jitter of every edge", KEY(amount, 0.2, 0, 0.45, REAL, "bit times at most"))
KIND(rate, BOTH, "the rate is off", KEY(amount, 3, -20, 20, REAL, "per cent"))
KIND(gap, BOTH, "a gap before a character", CHARACTER(1) KEY(amount, 2, 0, 1000, REAL, "characters long"))
KIND(cut, BOTH, "a cut frame", KEY(character, 4, -256, 255, WHOLE, "bytes that remain"))
KIND(extra, BOTH, "a byte too many", KEY(value, 0, 0, 255, WHOLE, "its value"))
KIND(swapped_crc, BOTH, "CRC bytes swapped", )
KIND(none, BOTH, "the frame is lost", )
KIND(late, ANSWER, "a late answer", KEY(amount, 100, 0, 60000, REAL, "milliseconds"))
KIND(echo, BOTH, "an echo", )
KIND(collision, BOTH, "another talker over the frame", CHARACTER(0) KEY(value, 85, 0, 255, WHOLE, "its characters"))

WHEN(every, 1, 1e9, WHOLE, "each n-th frame; without it and `probability` the next one")
WHEN(probability, 1e-9, 1, REAL, "of each frame")
WHEN(count, 1, 1e9, WHOLE, "at most so often")

#undef CHARACTER
