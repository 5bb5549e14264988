// SPDX-License-Identifier: BSD-3-Clause
// Decodes messages by packages of others: node decode_messages.mjs OUT.mcap < MESSAGES
//
// MESSAGES are lines of JSON: topic, type, and the CDR in hexadecimal digits. They are written to OUT.mcap with the
// published definitions of their types as schemas, read from there, decoded, and encoded again. Prints as JSON for each
// topic the type, the number of messages, how many of them differ when they are encoded again, and the last one.
// Working directory: where the packages are installed.
import { createRequire } from "node:module";
import fs from "node:fs/promises";
import path from "node:path";
import readline from "node:readline";

const require = createRequire(path.join(process.cwd(), "package.json"));
const { McapIndexedReader, McapWriter } = require("@mcap/core");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");
const { ros2humble } = require("@foxglove/rosmsg-msgs-common");
const { parse, stringify } = require("@foxglove/rosmsg");

// Of packages that rosmsg-msgs-common lacks, as their repositories have them.
const others = `
MSG: vision_msgs/Detection3DArray
std_msgs/Header header
vision_msgs/Detection3D[] detections
===
MSG: vision_msgs/Detection3D
std_msgs/Header header
vision_msgs/ObjectHypothesisWithPose[] results
vision_msgs/BoundingBox3D bbox
string id
===
MSG: vision_msgs/ObjectHypothesisWithPose
vision_msgs/ObjectHypothesis hypothesis
geometry_msgs/PoseWithCovariance pose
===
MSG: vision_msgs/ObjectHypothesis
string class_id
float64 score
===
MSG: vision_msgs/BoundingBox3D
geometry_msgs/Pose center
geometry_msgs/Vector3 size
===
MSG: nav2_dynamic_msgs/ObstacleArray
std_msgs/Header header
nav2_dynamic_msgs/Obstacle[] obstacles
===
MSG: nav2_dynamic_msgs/Obstacle
unique_identifier_msgs/UUID uuid
float32 score
geometry_msgs/Point position
geometry_msgs/Vector3 velocity
geometry_msgs/Vector3 size
float64[9] position_covariance
float64[9] velocity_covariance
===
MSG: unique_identifier_msgs/UUID
uint8[16] uuid
===
MSG: rmw_dds_common/ParticipantEntitiesInfo
rmw_dds_common/Gid gid
rmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq
===
MSG: rmw_dds_common/NodeEntitiesInfo
string<=256 node_namespace
string<=256 node_name
rmw_dds_common/Gid[] reader_gid_seq
rmw_dds_common/Gid[] writer_gid_seq
===
MSG: rmw_dds_common/Gid
uint8[16] data
`;

const texts = new Map();
for (const [name, definition] of Object.entries(ros2humble)) {
  texts.set(name, stringify([{ ...definition, name: undefined }]));
}
for (const text of others.split("===\n")) {
  const [, name, fields] = text.match(/MSG: (\S+)\n([^]*)/);
  texts.set(name, fields);
}

/** The text of a type and of all types within it. */
function schemaOf(type) {
  const names = new Set([type]);
  for (const name of names) {
    if (!texts.has(name)) throw new Error(`no definition of ${name}`);
    for (const [, within] of texts.get(name).matchAll(/^(\w+\/\w+)/gm)) names.add(within);
  }
  const [, ...within] = names;
  return texts.get(type) + within.map((name) => `\n${"=".repeat(80)}\nMSG: ${name}\n${texts.get(name)}`).join("");
}

async function write(file) {
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (bytes) => {
      await file.write(bytes);
      position += BigInt(bytes.byteLength);
    },
  };
  const mcap = new McapWriter({ writable });
  await mcap.start({ profile: "ros2", library: "test" });
  const channels = new Map();
  let sequence = 0;
  for await (const line of readline.createInterface({ input: process.stdin })) {
    const { topic, type, cdr } = JSON.parse(line);
    if (!channels.has(topic)) {
      const data = new TextEncoder().encode(schemaOf(type));
      const schemaId = await mcap.registerSchema({ name: type.replace("/", "/msg/"), encoding: "ros2msg", data });
      channels.set(topic, await mcap.registerChannel({
        schemaId, topic, messageEncoding: "cdr", metadata: new Map() }));
    }
    const time = BigInt(sequence);
    await mcap.addMessage({ channelId: channels.get(topic), sequence: sequence++, logTime: time, publishTime: time,
      data: Buffer.from(cdr, "hex") });
  }
  await mcap.end();
}

/** Whether the second is the first but for the padding at its end. */
function alike(bytes, again) {
  const padding = bytes.length - again.length;
  return padding >= 0 && padding < 4 && Buffer.compare(bytes.subarray(0, again.length), again) === 0;
}

async function read(bytes) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const codecs = new Map();
  for (const [id, schema] of reader.schemasById) {
    const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
    codecs.set(id, { name: schema.name, in: new MessageReader(definition), out: new MessageWriter(definition) });
  }
  const topics = {};
  for await (const { channelId, data } of reader.readMessages()) {
    const { topic, schemaId } = reader.channelsById.get(channelId);
    const codec = codecs.get(schemaId);
    const entry = (topics[topic] ??= { type: codec.name, messages: 0, different: 0 });
    const content = codec.in.readMessage(data);
    entry.messages += 1;
    if (!alike(data, codec.out.writeMessage(content))) entry.different += 1;
    entry.last = content;
  }
  return topics;
}

const [out] = process.argv.slice(2);
const file = await fs.open(out, "w");
await write(file);
await file.close();
/** Long arrays are printed as their number. */
const printable = (key, value) =>
  (!ArrayBuffer.isView(value) ? value : value.length > 36 ? value.length : Array.from(value));
console.log(JSON.stringify(await read(await fs.readFile(out)), printable));
