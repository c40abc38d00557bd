// Reads an ASAM OSI trace with other people's readers, holds its messages against OSI's published types, and compares it with the run folder:
//   node read_osi.js RUN FILE
const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { McapIndexedReader } = require("@mcap/core");
const { protobufFromBinaryDescriptor } = require("@mcap/support");
const osi = require("@lichtblick/asam-osi-types");
const protobuf = require("protobufjs");

const [runFolder, file] = process.argv.slice(2);
const seconds = 1000000000n;
const version = /^\d+\.\d+\.\d+$/;

function readable(bytes) {
  return {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
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

// The interfaces of OSI's published declarations: the type of each field by its name.
function publishedTypes() {
  const declarations = fs.readFileSync(require.resolve("@lichtblick/asam-osi-types").replace(/\.js$/, ".d.ts"), "utf8");
  const types = new Map();
  for (const [, name, body] of declarations.matchAll(/^interface (\w+) \{\n([\s\S]*?)^\}/gm))
    types.set(name, new Map([...body.matchAll(/^ {4}(\w+)\?: (.*?) \| undefined;/gm)].map(([, field, type]) => [field, type])));
  return types;
}

// Each message and field of the file is one of OSI's with the same type, each name of an enumeration has OSI's number.
function checkTypes(root) {
  const published = publishedTypes();
  const scalars = { double: "number", uint32: "number", uint64: "number", int64: "number" };
  const nameOf = (type) => type.fullName.replace(/^\.osi3\./, "").replaceAll(".", "_");
  const compared = { fields: 0, values: 0 };
  const walk = (space) => {
    for (const type of space.nestedArray ?? []) {
      if (type instanceof protobuf.Enum) {
        const theirs = osi[nameOf(type)];
        const prefix = type.name.replace(/([a-z])([A-Z])/g, "$1_$2").toUpperCase();
        for (const [name, number] of Object.entries(type.values)) assert.equal(theirs[name.slice(prefix.length + 1)], number, name), ++compared.values;
      } else if (type instanceof protobuf.Type) {
        const theirs = published.get(nameOf(type));
        assert.ok(theirs, `OSI has a message ${nameOf(type)}`);
        for (const field of type.fieldsArray) {
          field.resolve();
          const ours = (field.resolvedType ? nameOf(field.resolvedType) : scalars[field.type]) + (field.repeated ? "[]" : "");
          assert.equal(theirs.get(field.name), ours, `${nameOf(type)}.${field.name}`), ++compared.fields;
        }
      }
      walk(type);
    }
  };
  walk(root.lookup("osi3"));
  return compared;
}

async function checkFacts(reader) {
  assert.equal(reader.metadataIndexes.length, 1);
  for await (const { name, metadata } of reader.readMetadata()) {
    assert.equal(name, "net.asam.osi.trace");
    for (const key of ["version", "min_osi_version", "max_osi_version", "min_protobuf_version", "max_protobuf_version"]) assert.match(metadata.get(key), version, key);
  }
  const [channel, ...others] = reader.channelsById.values();
  assert.deepEqual(others, []);
  assert.equal(channel.messageEncoding, "protobuf");
  for (const key of ["osi_version", "protobuf_version"]) assert.match(channel.metadata.get(`net.asam.osi.trace.channel.${key}`), version, key);
  const schema = reader.schemasById.get(channel.schemaId);
  assert.deepEqual([schema.name, schema.encoding], ["osi3.SensorData", "protobuf"]);
  return schema;
}

const matrixOf = (numbers) => [0, 1, 2].map((i) => numbers.slice(4 * i, 4 * i + 3));
const transposed = (m) => m[0].map((_, i) => m.map((row) => row[i]));
const times = (m, v) => m.map((row) => row.reduce((sum, r, j) => sum + r * v[j], 0));
const product = (a, b) => transposed(transposed(b).map((column) => times(a, column)));
const listOf = ({ x = 0, y = 0, z = 0 }) => [x, y, z];
const upright = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]; // right, down, ahead to ahead, left, up

function turnOf({ roll = 0, pitch = 0, yaw = 0 }) {
  const [cr, sr, cp, sp, cy, sy] = [roll, pitch, yaw].flatMap((angle) => [Math.cos(angle), Math.sin(angle)]);
  const x = [[1, 0, 0], [0, cr, -sr], [0, sr, cr]];
  const y = [[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]];
  const z = [[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]];
  return product(z, product(y, x));
}

const nearMatrix = (m, expected, tolerance, what) => m.forEach((row, i) => row.forEach((value, j) => near(value, expected[i][j], tolerance, what)));
const nearVector = (v, expected, tolerance, what) => v.forEach((value, i) => near(value, expected[i], tolerance, what));

// The box as the run folder has it, seen from the frame's camera.
function checkObject(object, row, camera) {
  const where = `object ${row.track_id} in frame ${row.frame}`;
  const fromWorld = product(upright, transposed(matrixOf(camera)));
  const center = ["x", "y", "z"].map((axis, i) => Number(row[`center_${axis}_m`]) - camera[4 * i + 3]);
  nearVector(listOf(object.base.position), times(fromWorld, center), 2e-3, `center of ${where}`); // the table has millimeters
  const rotation = [0, 1, 2].map((i) => [0, 1, 2].map((j) => Number(row[`r${i}${j}`])));
  nearMatrix(turnOf(object.base.orientation), product(fromWorld, rotation), 1e-6, `turn of ${where}`);
  assert.equal(object.header.tracking_id.value, BigInt(row.track_id));
  near(object.header.existence_probability, Number(row.existence_probability), 1e-9, `existence of ${where}`);
  near(object.header.age, Number(row.age_s), 1e-9, `age of ${where}`);
  assert.equal(object.header.measurement_state, row.state === "predicted" ? 3 : 2);
  near(object.candidate.reduce((sum, { probability }) => sum + probability, 0), 1, 1e-12, `candidates of ${where}`);
  if (Number(row.length_m) > 0) nearVector([object.base.dimension.length, object.base.dimension.width, object.base.dimension.height], ["length_m", "width_m", "height_m"].map((name) => Number(row[name])), 1e-9, `size of ${where}`);
  const sigmas = ["x", "y", "z"].map((axis) => Number(row[`center_${axis}_sigma_m`]));
  // Turned or not, the variances of the three axes add up to the same.
  if (object.base_rmse.position) near(Math.hypot(...listOf(object.base_rmse.position)), Math.hypot(...sigmas), 2e-2, `error of ${where}`);
}

// From one frame to the next an object goes about as far as its relative velocity says.
function goesOn(before, now, time) {
  const was = before.moving_object.find(({ header }) => header.tracking_id.value === now.header.tracking_id.value);
  if (!was?.base.velocity || !now.base.velocity) return undefined;
  const [p, q, v, w] = [was.base.position, now.base.position, was.base.velocity, now.base.velocity].map(listOf);
  return { moved: Math.hypot(...p.map((x, i) => q[i] - x)), off: Math.hypot(...p.map((x, i) => q[i] - x - (time * (v[i] + w[i])) / 2)) };
}

async function main() {
  const bytes = fs.readFileSync(file);
  const reader = await McapIndexedReader.Initialize({ readable: readable(bytes) });
  const schema = await checkFacts(reader);
  const root = protobufFromBinaryDescriptor(schema.data);
  const { fields, values } = checkTypes(root);
  const type = root.lookupType(schema.name);
  const frames = table("frames.csv");
  const rows = table("objects_final.csv");
  const cameras = fs.readFileSync(path.join(runFolder, "camera_final.txt"), "utf8").trim().split("\n").map((line) => line.split(" ").map(Number));
  let index = 0, objects = 0, before;
  const moved = [], off = [];
  for await (const message of reader.readMessages()) {
    const data = type.toObject(type.decode(message.data), { longs: BigInt, arrays: true });
    const stamp = BigInt(frames[index].stamp_ns);
    assert.deepEqual([message.logTime, message.publishTime, data.timestamp.seconds * seconds + BigInt(data.timestamp.nanos)], [stamp, stamp, stamp]);
    const camera = cameras[index];
    nearVector(listOf(data.host_vehicle_location.position), times(upright, [3, 7, 11].map((i) => camera[i])), 1e-5, "the vehicle's place");
    nearMatrix(turnOf(data.host_vehicle_location.orientation), product(product(upright, matrixOf(camera)), transposed(upright)), 1e-6, "the vehicle's turn");
    const there = rows.filter((row) => row.frame === frames[index].frame);
    assert.equal(data.moving_object.length, there.length);
    data.moving_object.forEach((object, i) => checkObject(object, there[i], camera));
    for (const object of before ? data.moving_object : []) {
      const step = goesOn(before.data, object, Number(stamp - before.stamp) * 1e-9);
      if (step) moved.push(step.moved), off.push(step.off);
    }
    before = { data, stamp };
    objects += there.length;
    ++index;
  }
  assert.equal(index, frames.length);
  assert.ok(objects > 0);
  const mean = (list) => list.reduce((sum, value) => sum + value, 0) / list.length;
  assert.ok(mean(off) < 0.02 + 0.2 * mean(moved), `relative velocities are off by ${mean(off)} m a frame`);
  console.log(`${path.basename(file)}: ${index} messages, ${objects} objects, relative velocities off by ${(1000 * mean(off)).toFixed(0)} of ${(1000 * mean(moved)).toFixed(0)} mm a frame, ${fields} fields and ${values} values compared with OSI's`);
}

main().catch((error) => {
  console.error(`${file}: ${error.message}`);
  process.exit(1);
});
