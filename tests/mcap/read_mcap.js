// Reads an MCAP file of a run with other people's readers and compares it with the run folder:
//   node read_mcap.js RUN FILE KIND     KIND is `final` for an exported run, `online` for one that was written live
const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { protobufFromBinaryDescriptor } = require("@mcap/support");
const { foxgloveEnumSchemas, foxgloveMessageSchemas, generateProto } = require("@foxglove/schemas/internal");
const protobuf = require("protobufjs");

const [runFolder, file, kind] = process.argv.slice(2);
const seconds = 1000000000n;

function readable(bytes) {
  return {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
}

function decoders(schemas) {
  const byId = new Map();
  for (const schema of schemas) {
    assert.equal(schema.encoding, "protobuf");
    byId.set(schema.id, protobufFromBinaryDescriptor(schema.data).lookupType(schema.name));
  }
  return byId;
}

// Every message by its topic, decoded; the order within a topic is that of time.
async function readIndexed(bytes) {
  const reader = await McapIndexedReader.Initialize({ readable: readable(bytes) });
  const types = decoders(reader.schemasById.values());
  const topics = new Map();
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const type = types.get(channel.schemaId);
    if (!topics.has(channel.topic)) topics.set(channel.topic, []);
    topics.get(channel.topic).push({ logTime: message.logTime, publishTime: message.publishTime, value: type.toObject(type.decode(message.data), { longs: BigInt, arrays: true }) });
  }
  return { reader, topics };
}

function readStream(bytes) {
  const reader = new McapStreamReader();
  const counts = new Map();
  const topics = new Map();
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Channel") topics.set(record.id, record.topic);
    if (record.type === "Message") counts.set(topics.get(record.channelId), (counts.get(topics.get(record.channelId)) ?? 0) + 1);
  }
  return { counts, done: reader.done() };
}

// Rows of a CSV file as objects.
function table(name) {
  const [header, ...lines] = fs.readFileSync(path.join(runFolder, name), "utf8").trim().split("\n");
  const columns = header.split(",");
  return lines.map((line) => Object.fromEntries(line.split(",").map((field, i) => [columns[i], field])));
}

function near(value, expected, tolerance, what) {
  assert.ok(Math.abs(value - expected) <= tolerance, `${what}: ${value}, not ${expected}`);
}

function rotationOf({ x = 0, y = 0, z = 0, w = 0 }) {
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
  ];
}

function checkSchemas(reader) {
  const root = new protobuf.Root();
  for (const [name, schema] of Object.entries(foxgloveMessageSchemas))
    protobuf.parse(generateProto(schema, Object.values(foxgloveEnumSchemas).filter((e) => e.parentSchemaName === name)), root);
  let compared = 0;
  for (const schema of reader.schemasById.values()) {
    const ours = protobufFromBinaryDescriptor(schema.data).lookup("foxglove");
    for (const type of ours?.nestedArray ?? []) {
      const theirs = root.lookupType(`foxglove.${type.name}`);
      const fields = (of) => of.fieldsArray.map((f) => `${f.id} ${f.repeated ? "repeated " : ""}${f.type.replace(/^\.?(foxglove\.)?/, "").split(".").pop()} ${f.name.toLowerCase().replaceAll("_", "")}`).sort();
      assert.deepEqual(fields(type), fields(theirs), `fields of ${type.name}`);
      ++compared;
    }
  }
  return compared;
}

function checkTimes(topics, frames) {
  const stamps = frames.map((row) => BigInt(row.stamp_ns));
  for (const [topic, messages] of topics) {
    for (const { logTime, publishTime, value } of messages) {
      assert.ok(stamps.includes(logTime), `${topic}: no frame was taken at ${logTime}`);
      assert.equal(publishTime, logTime);
      const { seconds: s = 0n, nanos = 0 } = value.timestamp ?? value.transforms?.[0].timestamp ?? value.entities?.[0]?.timestamp ?? { seconds: logTime / seconds, nanos: Number(logTime % seconds) };
      assert.equal(BigInt(s) * seconds + BigInt(nanos), logTime, topic);
    }
  }
}

function checkCuboid(cube, row) {
  const rotation = [0, 1, 2].map((i) => [0, 1, 2].map((j) => Number(row[`r${i}${j}`])));
  const translation = [row.tx, row.ty, row.tz].map(Number);
  const center = [row.box_x_m, row.box_y_m, row.box_z_m].map(Number);
  const { position, orientation } = cube.pose;
  ["x", "y", "z"].forEach((axis, i) => {
    const expected = translation[i] + rotation[i].reduce((sum, r, j) => sum + r * center[j], 0);
    near(position[axis] ?? 0, expected, 2e-3, `center ${axis} in frame ${row.frame}`); // the table has millimeters
    rotationOf(orientation)[i].forEach((r, j) => near(r, rotation[i][j], 1e-6, `rotation in frame ${row.frame}`));
  });
  ["length", "width", "height"].forEach((name, i) => near(cube.size[["x", "y", "z"][i]] ?? 0, Number(row[`${name}_m`]), 1e-3, name));
}

function checkObjects(topics, frames) {
  const rows = table(`objects_${kind}.csv`);
  const frameAt = new Map(frames.map((row) => [BigInt(row.stamp_ns), row.frame]));
  let cuboids = 0;
  const shown = new Set();
  for (const { logTime, value } of topics.get("/objects")) {
    const there = rows.filter((row) => row.frame === frameAt.get(logTime));
    for (const { id } of value.deletions) assert.ok(shown.delete(id), `${id} is deleted twice`);
    assert.deepEqual(value.entities.map((entity) => entity.id), there.map((row) => `object_${row.track_id}`));
    value.entities.forEach((entity, i) => {
      shown.add(entity.id);
      const facts = Object.fromEntries(entity.metadata.map(({ key, value: fact }) => [key, fact]));
      assert.equal(facts.state, there[i].state);
      near(Number(facts.speed_mps), Math.hypot(...["vx", "vy", "vz"].map((v) => Number(there[i][v]))), 2e-4, "speed");
      assert.equal(entity.cubes.length, Number(there[i].length_m) > 0 ? 1 : 0);
      for (const cube of entity.cubes) checkCuboid(cube, there[i]), ++cuboids;
    });
    assert.equal(shown.size, value.entities.length, "what is gone is deleted");
  }
  return cuboids;
}

function checkPoses(topics) {
  const lines = fs.readFileSync(path.join(runFolder, `camera_${kind}.txt`), "utf8").trim().split("\n");
  const poses = topics.get("/camera/pose");
  assert.equal(poses.length, lines.length);
  lines.forEach((line, i) => {
    const numbers = line.split(" ").map(Number);
    const { position, orientation } = poses[i].value.pose;
    ["x", "y", "z"].forEach((axis, j) => near(position[axis] ?? 0, numbers[4 * j + 3], 1e-6, `camera ${axis} in line ${i + 1}`));
    rotationOf(orientation).forEach((row, j) => row.forEach((r, k) => near(r, numbers[4 * j + k], 1e-6, "camera's rotation")));
  });
  for (const { value } of topics.get("/tf")) {
    const [map, camera] = value.transforms;
    assert.deepEqual([map.parent_frame_id, map.child_frame_id, camera.parent_frame_id, camera.child_frame_id], ["map", "world", "world", "camera"]);
    const upright = rotationOf(map.rotation); // the camera's axes are right, down, ahead; the map's ahead, left, up
    [[0, 0, 1], [-1, 0, 0], [0, -1, 0]].forEach((row, i) => row.forEach((r, j) => near(upright[i][j], r, 1e-9, "map")));
  }
}

function checkImages(topics) {
  for (const { value } of topics.get("/camera/left/compressed")) {
    assert.equal(value.format, "jpeg");
    assert.equal(value.frame_id, "camera");
    assert.deepEqual([...value.data.subarray(0, 2), ...value.data.subarray(-2)], [0xff, 0xd8, 0xff, 0xd9]);
  }
}

// Wherever the file is cut, what was written as whole chunks comes out of a reader that reads from the start.
function checkCut(bytes, all) {
  let last = -1;
  for (const share of [0.1, 0.37, 0.5, 0.83, 0.99]) {
    const { counts, done } = readStream(bytes.subarray(0, Math.floor(share * bytes.length)));
    assert.ok(!done);
    const count = counts.get("/camera/pose") ?? 0;
    assert.ok(count >= last && count <= all);
    last = count;
  }
  assert.ok(last > 0.5 * all, `${last} of ${all} frames in 99 % of the file`);
}

async function main() {
  const bytes = fs.readFileSync(file);
  const { reader, topics } = await readIndexed(bytes);
  const streamed = readStream(bytes);
  assert.ok(streamed.done);
  const frames = table("frames.csv").filter((row) => kind === "final" || row.status !== "dropped");
  for (const topic of ["/camera/calibration", "/camera/left/compressed", "/camera/pose", "/diagnostics", "/objects", "/points", "/tf"])
    assert.equal(topics.get(topic)?.length, frames.length, topic);
  for (const [topic, messages] of topics) assert.equal(streamed.counts.get(topic), messages.length, topic);
  assert.equal(reader.statistics.messageCount, BigInt([...topics.values()].reduce((sum, messages) => sum + messages.length, 0)));
  for (const chunk of reader.chunkIndexes) assert.ok(chunk.messageEndTime - chunk.messageStartTime < seconds, "a chunk holds at most a second");
  const schemas = checkSchemas(reader);
  checkTimes(topics, frames);
  checkPoses(topics);
  checkImages(topics);
  const cuboids = checkObjects(topics, frames);
  assert.ok(cuboids > 0);
  checkCut(bytes, frames.length);
  console.log(`${path.basename(file)}: ${frames.length} frames, ${cuboids} cuboids, ${reader.chunkIndexes.length} chunks, ${schemas} message types compared with Foxglove's`);
}

main().catch((error) => {
  console.error(`${file}: ${error.message}`);
  process.exit(1);
});
