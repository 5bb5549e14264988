// SPDX-License-Identifier: BSD-3-Clause
// Reads an MCAP file with readers that are not headway's, and prints as JSON what is in it: for each
// topic its schema, the number of its messages, and the first and last of them; and every field that
// differs from Foxglove's published schemas.
import fs from 'node:fs/promises';
import {createRequire} from 'node:module';

const require = createRequire(import.meta.url);
const {McapIndexedReader} = require('@mcap/core');
const zstd = require('@foxglove/wasm-zstd');
const schemas = require('@foxglove/schemas/internal');
const protobuf = require('protobufjs');
const descriptor = require('protobufjs/ext/descriptor');

await zstd.isLoaded;
const bytes = await fs.readFile(process.argv[2]);
const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => new Uint8Array(bytes.buffer, bytes.byteOffset + Number(offset), Number(size)),
};
const reader = await McapIndexedReader.Initialize({
  readable,
  decompressHandlers: {zstd: (data, size) => zstd.decompress(data, Number(size))},
});

/** Numbers and types of the fields of a published schema; null if there is none of the name. */
function publishedFields(name) {
  const schema = schemas.foxgloveMessageSchemas[name];
  if (!schema) return null;
  const enums = Object.values(schemas.foxgloveEnumSchemas).filter((e) => e.parentSchemaName === name);
  const text = schemas.generateProto(schema, enums).replace(/^import.*$/gm, '');
  return protobuf.parse(text, {keepCase: true}).root.lookupType(`foxglove.${name}`);
}

const plain = (type) => type.replace(/^\.?(foxglove\.)?/, '').replace(/^.*\./, '');
const differences = [];
function compare(type) {
  const published = publishedFields(type.name);
  if (!published) return differences.push(`${type.name}: is not published`);
  for (const field of type.fieldsArray) {
    const other = published.fields[field.name];
    const alike = other && other.id === field.id && plain(other.type) === plain(field.type) &&
        other.repeated === field.repeated;
    if (!alike) differences.push(`${type.name}.${field.name}`);
  }
}

const types = new Map();
for (const [id, schema] of reader.schemasById) {
  const root = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(schema.data));
  types.set(id, root.lookupType(schema.name));
  for (const type of root.lookup('foxglove').nestedArray) {
    if (type instanceof protobuf.Type) compare(type);
  }
}

const topics = {};
let lastTime = 0n;
let inOrder = true;
for await (const message of reader.readMessages()) {
  const {topic, schemaId} = reader.channelsById.get(message.channelId);
  const type = types.get(schemaId);
  const value = type.toObject(type.decode(message.data), {longs: Number, enums: String});
  const entry = topics[topic] ??= {schema: type.fullName.slice(1), messages: 0, first: value};
  entry.messages += 1;
  entry.last = value;
  inOrder = inOrder && message.logTime >= lastTime;
  lastTime = message.logTime;
}
const statistics = reader.statistics;
/** Bytes are printed as their number. */
const printable = (key, value) => (value instanceof Uint8Array ? value.length : value);
console.log(JSON.stringify({
  differences: [...new Set(differences)], topics, inOrder,
  messages: Number(statistics.messageCount), start: Number(statistics.messageStartTime) / 1e9,
  end: Number(statistics.messageEndTime) / 1e9, chunks: statistics.chunkCount,
}, printable));
