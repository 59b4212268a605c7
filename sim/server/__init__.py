# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""The server beside the bridge: frames in words, values that move, the control interface, captures.

Standard library only, but for web.py (aiohttp) and the FST of capture.py (pylibfst).
"""
