// SPDX-License-Identifier: Apache-2.0
// Copyright (c) 2026 the project contributors
//
// master.js LINK rtu|ascii: reads, writes and an exception by modbus-serial; one line of JSON tells what came.
"use strict";

const ModbusRTU = require("modbus-serial");
const [link, mode] = process.argv.slice(2);

(async () => {
  const client = new ModbusRTU();
  const open = mode === "ascii" ? client.connectAsciiSerial : client.connectRTUBuffered;
  await open.call(client, link, { baudRate: 19200 });
  client.setID(17);
  client.setTimeout(3000);
  const told = {};
  told.holdings = (await client.readHoldingRegisters(107, 3)).data;
  told.inputs = (await client.readInputRegisters(8, 1)).data;
  told.discretes = (await client.readDiscreteInputs(0, 8)).data;
  const words = Array.from({ length: 123 }, (_, i) => (i * 523) & 0xffff);
  await client.writeRegisters(200, words);
  told.longest = (await client.readHoldingRegisters(200, 125)).data.slice(0, 123).every((word, i) => word === words[i]);
  await client.writeRegister(300, 0xbeef);
  told.single = (await client.readHoldingRegisters(300, 1)).data;
  await client.writeCoils(5, [true, false, true]);
  await client.writeCoil(9, true);
  told.coils = (await client.readCoils(5, 5)).data.slice(0, 5);
  told.exception = await client.readHoldingRegisters(60000, 1).then(() => 0, (error) => error.modbusCode);
  told.again = 0;
  for (let i = 0; i < 50; ++i) told.again += (await client.readHoldingRegisters(107, 3)).data[0] === 555;
  console.log(JSON.stringify(told));
  client.close(() => {});
})().catch((error) => {
  console.error(String(error.message || error));
  process.exit(1);
});
