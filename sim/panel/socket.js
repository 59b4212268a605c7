// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// socket - the back end of the panel that make serve WEB=... serves: one WebSocket, {id, op, ...} and its answers, and events.
"use strict";

(() => {
  const AGAIN_MS = 1000;
  const listeners = [], waiting = new Map();
  let socket = null, id = 0;
  const tell = (event) => listeners.forEach((listener) => listener(event));

  const connect = () => {
    socket = new WebSocket(new URL("api/events", location.href.replace(/^http/, "ws")));
    socket.onopen = () => tell({ event: "connection", open: true });
    socket.onmessage = ({ data }) => {
      const message = JSON.parse(data);
      if (message.id === undefined) return tell(message);
      const call = waiting.get(message.id);
      waiting.delete(message.id);
      if (!call) return undefined;
      return message.error !== undefined ? call.reject(new Error(message.error)) : call.resolve(message.result);
    };
    socket.onclose = () => {
      for (const call of waiting.values()) call.reject(new Error("The device does not answer."));
      waiting.clear();
      tell({ event: "connection", open: false });
      setTimeout(connect, AGAIN_MS);
    };
  };

  Panel.use({
    onEvent: (listener) => listeners.push(listener),
    call: (op, given = {}) => new Promise((resolve, reject) => {
      if (!socket || socket.readyState !== WebSocket.OPEN) return reject(new Error("The device does not answer."));
      waiting.set(++id, { resolve, reject });
      return socket.send(JSON.stringify({ ...given, id, op }));
    }),
  });
  connect();
})();
