// Writes the images of a drive to a bag with other people's writers:
//   node write_bag.js DRIVE FILE PROFILE KIND COMPRESSION     ros1|ros2|foxglove, raw|compressed, none|zstd|lz4
// DRIVE has image_0, image_1 and calib.txt as KITTI's, and times.txt, or else a pair each tenth of a second. Where the first time is 0,
// the first heads tell none.
const fs = require("node:fs");
const path = require("node:path");
const lz4 = require("lz4js");
const { ZstdCodec } = require("zstd-codec");
const { McapWriter } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { ros1, ros2humble } = require("@foxglove/rosmsg-msgs-common");
const ros1Writer = require("@foxglove/rosmsg-serialization").MessageWriter;
const ros2Writer = require("@foxglove/rosmsg2-serialization").MessageWriter;
const { foxgloveMessageSchemas, generateProto } = require("@foxglove/schemas/internal");
const { PNG } = require("pngjs");
const protobuf = require("protobufjs");

const [drive, file, profile, kind, compression] = process.argv.slice(2);
const isRos2 = profile === "ros2";
const isFoxglove = profile === "foxglove";
const definitions = isRos2 ? ros2humble : ros1;
const second_ns = 1000000000n;

const keyOf = (name) => name.replace("/msg/", "/");
const foxgloveNames = { Image: "RawImage", CompressedImage: "CompressedImage", CameraInfo: "CameraCalibration" };
const foxgloveName = (name) => foxgloveNames[name.split("/").pop()];
const typeName = (name) => (isFoxglove ? `foxglove.${foxgloveName(name)}` : isRos2 ? name : keyOf(name));

function timesOf(count) {
  const times = path.join(drive, "times.txt");
  if (!fs.existsSync(times)) return Array.from({ length: count }, (_, i) => BigInt(i) * (second_ns / 10n));
  const lines = fs.readFileSync(times, "utf8").trim().split(/\s+/);
  return lines.map((text) => {
    const [whole, part] = text.split(".");
    return BigInt(whole) * second_ns + BigInt(part.padEnd(9, "0").slice(0, 9));
  });
}

// The definition of a type and of all that it is made of.
function definitionsOf(name, found = new Map()) {
  if (found.has(name)) return found;
  found.set(name, definitions[keyOf(name)]);
  for (const field of found.get(name).definitions) if (field.isComplex) definitionsOf(field.type, found);
  return found;
}

function writerOf(name) {
  const all = [...definitionsOf(name).values()];
  const Writer = isRos2 ? ros2Writer : ros1Writer;
  const writer = new Writer(all.map((definition, i) => (i === 0 ? { ...definition, name: undefined } : definition)));
  return (message) => writer.writeMessage(message);
}

// Writes a message of ROS as Foxglove's of the same meaning.
function foxgloveWriterOf(name) {
  const { root } = protobuf.parse(generateProto(foxgloveMessageSchemas[foxgloveName(name)], []), new protobuf.Root(), { keepCase: true });
  root.addJSON(protobuf.common.get("google/protobuf/timestamp.proto").nested);
  const type = root.lookupType(typeName(name));
  return ({ header: { stamp, frame_id }, ...fields }) =>
    type.encode(type.fromObject({ timestamp: { seconds: stamp.sec, nanos: stamp.nsec }, frame_id, ...fields })).finish();
}

function header(index) {
  const time_ns = times[index];
  const sec = Number(time_ns / second_ns);
  const nsec = Number(time_ns % second_ns);
  return { seq: index, stamp: isRos2 ? { sec, nanosec: nsec, nsec } : { sec, nsec }, frame_id: "camera" };
}

const leftNames = fs.readdirSync(path.join(drive, "image_0")).sort();
const times = timesOf(leftNames.length);

// KITTI's line `Pn: ...`.
function projection(side) {
  const line = fs.readFileSync(path.join(drive, "calib.txt"), "utf8").split("\n").find((text) => text.startsWith(`P${side}:`));
  return line.split(/\s+/).slice(1, 13).map(Number);
}

function cameraInfo(index, side, size) {
  const P = projection(side);
  const K = [P[0], 0, P[2], 0, P[5], P[6], 0, 0, 1];
  const R = [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const D = [0, 0, 0, 0, 0];
  const names = isRos2 ? { d: D, k: K, r: R, p: P } : { D, K, R, P };
  const roi = { x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false };
  return { header: header(index), ...size, distortion_model: "plumb_bob", ...names, binning_x: 0, binning_y: 0, roi };
}

function image(index, file) {
  const bytes = fs.readFileSync(file);
  const png = PNG.sync.read(bytes);
  const size = { width: png.width, height: png.height };
  if (kind === "compressed") return { size, message: { header: header(index), format: "png", data: new Uint8Array(bytes) } };
  const gap = 5;  // bytes behind each row
  const step = png.width + gap;
  const data = new Uint8Array(step * png.height);
  for (let y = 0; y < png.height; ++y)
    for (let x = 0; x < png.width; ++x) data[y * step + x] = png.data[4 * (y * png.width + x)];
  return { size, message: { header: header(index), ...size, encoding: "mono8", is_bigendian: 0, step, data } };
}

function compressor(zstd) {
  if (compression === "zstd") return (data) => ({ compression: "zstd", compressedData: new zstd.Simple().compress(data) });
  if (compression === "lz4") return (data) => ({ compression: "lz4", compressedData: new Uint8Array(lz4.compress(data)) });
  return undefined;
}

async function addTopic(writer, topic, type) {
  const name = typeName(type);
  const data = new TextEncoder().encode("# the readers of the test know the type\n");
  const schemaId = await writer.registerSchema({ name, encoding: isFoxglove ? "protobuf" : isRos2 ? "ros2msg" : "ros1msg", data });
  const channel = { schemaId, topic, messageEncoding: isFoxglove ? "protobuf" : isRos2 ? "cdr" : "ros1", metadata: new Map() };
  return { id: await writer.registerChannel(channel), write: isFoxglove ? foxgloveWriterOf(type) : writerOf(name) };
}

async function writeBag(zstd) {
  const descriptor = fs.openSync(file, "w");
  let position = 0n;
  const writable = {
    position: () => position,
    write: async (bytes) => {
      fs.writeSync(descriptor, bytes);
      position += BigInt(bytes.length);
    },
  };
  const writer = new McapWriter({ writable, chunkSize: 1 << 20, compressChunk: compressor(zstd) });
  await writer.start({ profile, library: "write_bag.js" });
  const imageType = kind === "raw" ? "sensor_msgs/msg/Image" : "sensor_msgs/msg/CompressedImage";
  const end = kind === "raw" ? "" : "/compressed";
  const sides = [];
  for (const [side, name] of ["left", "right"].entries())
    sides.push({
      side,
      folder: path.join(drive, `image_${side}`),
      images: await addTopic(writer, `/stereo/${name}/image_raw${end}`, imageType),
      infos: await addTopic(writer, `/stereo/${name}/camera_info`, "sensor_msgs/msg/CameraInfo"),
    });
  for (const [index, name] of leftNames.entries())
    for (const { side, folder, images, infos } of index % 2 ? sides : [...sides].reverse()) {
      const { size, message } = image(index, path.join(folder, name));
      const time = times[index];
      const put = ({ id, write }, content) =>
        writer.addMessage({ channelId: id, sequence: index, logTime: time, publishTime: time, data: write(content) });
      await put(infos, cameraInfo(index, side, size));
      await put(images, message);
    }
  await writer.end();
  fs.closeSync(descriptor);
}

ZstdCodec.run((zstd) => writeBag(zstd));
