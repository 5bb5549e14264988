// SPDX-License-Identifier: BSD-3-Clause
// Writes the recording as ROS 2 by packages of others: node write_ros2.mjs OUT COMPRESSION < MESSAGES
//
// OUT.mcap by @mcap/core, with chunks compressed by COMPRESSION (none, lz4, zstd); another name: one
// line of JSON for each message, with its CDR in base64, for write_db3.py. MESSAGES are those of
// recording.py. Working directory: where the packages are installed.
import { createRequire } from "node:module";
import fs from "node:fs";
import path from "node:path";
import readline from "node:readline";

const require = createRequire(path.join(process.cwd(), "package.json"));
const { McapWriter } = require("@mcap/core");
const { MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { ros2humble } = require("@foxglove/rosmsg-msgs-common");

const definitions = new Map();
for (const [name, definition] of Object.entries(ros2humble)) {
  definitions.set(name.replace("/msg/", "/"), { ...definition, name });
}

// A type and all types within it, as the writer of messages wants them.
function closure(type, found = new Map()) {
  const definition = definitions.get(type.replace("/msg/", "/"));
  if (definition == undefined) throw new Error(`no definition of ${type}`);
  if (found.has(definition.name)) return found;
  found.set(definition.name, definition);
  for (const field of definition.definitions) {
    if (field.isComplex === true) closure(field.type, found);
  }
  return found;
}

function plain(value) {
  if (Array.isArray(value)) return value.map(plain);
  if (value === null || typeof value !== "object") return value;
  if ("base64" in value) return new Uint8Array(Buffer.from(value.base64, "base64"));
  return Object.fromEntries(Object.entries(value).map(([name, one]) => [name, plain(one)]));
}

const writers = new Map();
function cdrOf(type, message) {
  if (!writers.has(type)) writers.set(type, new MessageWriter([...closure(type).values()]));
  return writers.get(type).writeMessage(plain(message));
}

class File {
  constructor(name) {
    this.descriptor = fs.openSync(name, "w");
    this.written = 0n;
  }
  position() {
    return this.written;
  }
  async write(bytes) {
    fs.writeSync(this.descriptor, bytes);
    this.written += BigInt(bytes.byteLength);
  }
}

async function compressor(name) {
  if (name === "none") return undefined;
  const module = require(name === "lz4" ? "lz4js" : "@foxglove/wasm-zstd");
  await module.isLoaded;
  return (bytes) => ({
    compression: name,
    compressedData: Uint8Array.from(module.compress(bytes)),
  });
}

const [out, compression] = process.argv.slice(2);
const isMcap = out.endsWith(".mcap");
const file = new File(out);
const mcap = isMcap
  ? new McapWriter({ writable: file, chunkSize: 20000, compressChunk: await compressor(compression) })
  : undefined;
if (mcap) await mcap.start({ profile: "ros2", library: "test" });
const channels = new Map();
let sequence = 0;
// JSON has no infinity, which Python writes nevertheless.
const parse = (line) =>
  JSON.parse(line.replace(/\bInfinity\b/g, "1e999").replace(/\bNaN\b/g, "null"));
for await (const line of readline.createInterface({ input: process.stdin })) {
  const { topic, type, time, message } = parse(line);
  const content = cdrOf(type, message);
  const type2 = type.replace("/", "/msg/");
  if (!mcap) {
    const base64 = Buffer.from(content).toString("base64");
    await file.write(Buffer.from(JSON.stringify({ topic, type: type2, time, base64 }) + "\n"));
    continue;
  }
  if (!channels.has(topic)) {
    const schemaId = await mcap.registerSchema({
      name: type2, encoding: "ros2msg", data: new Uint8Array() });
    channels.set(topic, await mcap.registerChannel({
      schemaId, topic, messageEncoding: "cdr", metadata: new Map() }));
  }
  await mcap.addMessage({
    channelId: channels.get(topic), sequence: sequence++, logTime: BigInt(time),
    publishTime: BigInt(time), data: content });
}
if (mcap) await mcap.end();
