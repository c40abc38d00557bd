#include "apps/export/osi_trace.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <osi3/osi_sensordata.pb.h>

#include "io/bag/mcap_reader.hpp"
#include "io/files/errors.hpp"
#include "tests/apps/export/mcap_reading.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using osi3::DetectedItemHeader;
using osi3::DetectedMovingObject;
using osi3::MovingObject;
using osi3::SensorData;

constexpr int kFrames = 12;
constexpr double kNear = 1e-9;

/// Axes of a body that drives where the camera looks: ahead, left and up of (right, down, ahead).
Eigen::Matrix3d facingAhead() {
  Eigen::Matrix3d world_body;
  world_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  return world_body;
}

/// A car 12 m ahead of the first camera, 3 m to its right, its bottom 1.5 m below it; slower than the camera by 4 m/s.
ObjectEstimate carAt(int index) {
  ObjectEstimate car;
  car.track = {7};
  car.T_world_body = SE3(facingAhead(), {3, 1.5, 12 + 0.6 * index});
  car.velocity_world_mps = {0, 0, 6};
  car.speed_sigma_mps = 0.25;
  car.existence_probability = 0.875;
  car.age_s = 0.1 * index;
  car.cuboid = ObjectBox{.center_body = {1, 0.5, 0.75},
                         .size_m = {4, 2, 1.5},
                         .center_sigma_m = {0.3, 0.2, 0.1},
                         .size_sigma_m = {0.4, 0.3, 0.2},
                         .kind = ObjectKind::kCar,
                         .kind_probability = 0.75};
  car.acceleration = {.along_mps2 = -1, .along_sigma_mps2 = 0.5};
  return car;
}

Matrix6d diagonal(double rho, double phi) {
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << rho, 4 * rho, 9 * rho, phi, 4 * phi, 9 * phi;
  return covariance;
}

/// A camera that drives straight ahead at 10 m/s; frame 5 is predicted, frame 9 was of no use.
RunFolder drive() {
  RunFolder run{.folder = "runs/drive", .first_frame = 100};
  for (int i = 0; i < kFrames; ++i) {
    const FrameId frame{100 + i};
    run.frames.push_back({.head = {.frame = frame,
                                   .stamp = {1'700'000'000'900'000'000 + std::int64_t{100'000'000} * i},
                                   .status = i == 9 ? FrameStatus::kRejected : FrameStatus::kGood,
                                   .cause = i == 9 ? FrameCause::kUnusable : FrameCause::kNone}});
    run.final.camera.emplace_back(Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, i));
    run.final.pose_covariances.push_back({frame, {}, diagonal(1e-4 * i, 1e-6 * i)});
    if (i < 2) continue;
    ObjectEstimate car = carAt(i);
    if (i == 5) car.state = ObjectState::kPredicted;
    run.final.objects.push_back({frame, car});
    run.final.covariances.push_back({frame, car.track, diagonal(1e-2, 1e-4)});
  }
  return run;
}

class OsiTraceFile : public testing::Test {
 protected:
  std::vector<SensorData> exported(const RunFolder& run, const std::optional<SE3>& T_vehicle_sensor = {}) {
    const OsiTrace trace = exportOsi(run, folder_ / "trace.mcap", T_vehicle_sensor);
    McapReader reader(folder_ / "trace.mcap");
    EXPECT_EQ(reader.topics().at(0).type, "osi3.SensorData");
    EXPECT_EQ(reader.topics().at(0).messages, trace.frames);
    std::vector<SensorData> messages;
    while (const auto message = reader.next()) {
      messages.emplace_back();
      EXPECT_TRUE(messages.back().ParseFromArray(message->data.data(), static_cast<int>(message->data.size())));
      const osi3::Timestamp& time = messages.back().timestamp();
      EXPECT_EQ(time.seconds() * 1'000'000'000 + time.nanos(), message->log_ns);
    }
    return messages;
  }
  /// Cars of a drive whose object is changed so in all frames.
  DetectedMovingObject carOf(const std::function<void(ObjectEstimate&)>& change) {
    RunFolder run = drive();
    for (auto& row : run.final.objects) change(row.object);
    return exported(run).at(4).moving_object(0);
  }

  test::TemporaryFolder folder_;
};

void expectVector(const osi3::Vector3d& told, const Eigen::Vector3d& expected) {
  EXPECT_LT((Eigen::Vector3d(told.x(), told.y(), told.z()) - expected).norm(), kNear) << told.ShortDebugString();
}

void expectAngles(const osi3::Orientation3d& told, const Eigen::Vector3d& expected) {
  EXPECT_LT((Eigen::Vector3d(told.roll(), told.pitch(), told.yaw()) - expected).norm(), kNear)
      << told.ShortDebugString();
}

TEST_F(OsiTraceFile, HasAMessageForEachFrameWithItsTimes) {
  const auto messages = exported(drive());
  ASSERT_EQ(messages.size(), std::size_t{kFrames});
  for (int i = 0; i < kFrames; ++i) {
    const SensorData& message = messages[i];
    EXPECT_EQ(message.version().version_major(), 3U);
    EXPECT_EQ(message.timestamp().seconds(), 1'700'000'000 + (i + 9) / 10);
    EXPECT_EQ(message.timestamp().nanos(), 100'000'000U * ((i + 9) % 10));
    EXPECT_EQ(message.last_measurement_time().nanos(), message.timestamp().nanos());
    EXPECT_EQ(message.sensor_id().value(), 1U);
    EXPECT_EQ(message.moving_object_header().cycle_counter(), 100U + i);
    EXPECT_EQ(message.moving_object_header().data_qualifier(),
              i == 9 ? osi3::DetectedEntityHeader::DATA_QUALIFIER_NOT_AVAILABLE
                     : osi3::DetectedEntityHeader::DATA_QUALIFIER_AVAILABLE);
    EXPECT_EQ(message.moving_object_size(), i < 2 ? 0 : 1);
    EXPECT_FALSE(message.has_mounting_position());
  }
}

TEST_F(OsiTraceFile, AnObjectsBoxIsWhereTheSensorSeesIt) {
  const auto messages = exported(drive());
  for (int i = 2; i < kFrames; ++i) {
    const DetectedMovingObject& car = messages[i].moving_object(0);
    // The camera is 0.4 m nearer in each frame; the center is 1 m ahead of the origin, 0.5 m to its left, 0.75 m above.
    expectVector(car.base().position(), {13 - 0.4 * i, -2.5, -0.75});
    expectAngles(car.base().orientation(), {0, 0, 0});
    EXPECT_EQ(car.base().dimension().length(), 4);
    EXPECT_EQ(car.base().dimension().width(), 2);
    EXPECT_EQ(car.base().dimension().height(), 1.5);
  }
}

TEST_F(OsiTraceFile, AnObjectsMotionIsRelativeToTheSensor) {
  const auto messages = exported(drive());
  for (int i = 2; i < kFrames; ++i) {
    const osi3::BaseMoving& base = messages[i].moving_object(0).base();
    ASSERT_EQ(base.has_velocity(), i != 9) << "the camera's motion in a frame of no use is not known";
    if (i == 9) continue;
    expectVector(base.velocity(), {6 - 10, 0, 0});
    EXPECT_NEAR(base.acceleration().x(), -1, 1e-6);
    EXPECT_NEAR(base.orientation_rate().yaw(), 0, kNear);
  }
}

TEST_F(OsiTraceFile, ATurnToTheLeftIsPositive) {
  const DetectedMovingObject car = carOf([](ObjectEstimate& object) {
    object.T_world_body = object.T_world_body * SE3(expSO3({0, 0, 0.25}), Eigen::Vector3d::Zero());
    object.yaw_rate_radps = 0.5;
    object.yaw_rate_sigma_radps = 0.125;
  });
  expectAngles(car.base().orientation(), {0, 0, 0.25});
  EXPECT_NEAR(car.base().orientation_rate().yaw(), 0.5, kNear);
  EXPECT_NEAR(car.base_rmse().orientation_rate().yaw(), 0.125, kNear);
}

TEST_F(OsiTraceFile, ErrorsComeFromTheCovariances) {
  const osi3::BaseMoving rmse = exported(drive()).at(4).moving_object(0).base_rmse();
  expectAngles(rmse.orientation(), {0.01, 0.02, 0.03});
  // The center is off by the body's error, by its turn about the origin and by its own error. For d = (1, 0.5, 0.75)
  // and turns (p, q, r) the turn moves it by (q d_z - r d_y, r d_x - p d_z, p d_y - q d_x).
  const double pp = 1e-4, qq = 4e-4, rr = 9e-4;
  expectVector(rmse.position(), {std::sqrt(1e-2 + 0.09 + qq * 0.5625 + rr * 0.25),
                                 std::sqrt(4e-2 + 0.04 + rr + pp * 0.5625), std::sqrt(9e-2 + 0.01 + pp * 0.25 + qq)});
  EXPECT_EQ(rmse.dimension().length(), 0.4);
  EXPECT_EQ(rmse.dimension().height(), 0.2);
  expectVector(rmse.velocity(), {0.25, 6 * 0.03, 0});
  expectVector(rmse.acceleration(), {0.5, 0, 0});
}

TEST_F(OsiTraceFile, AnObjectWithoutCovarianceHasNoErrorsOfItsPose) {
  RunFolder run = drive();
  run.final.covariances.clear();
  const osi3::BaseMoving rmse = exported(run).at(4).moving_object(0).base_rmse();
  EXPECT_FALSE(rmse.has_position());
  EXPECT_FALSE(rmse.has_orientation());
  EXPECT_TRUE(rmse.has_dimension());
}

TEST_F(OsiTraceFile, AnObjectsHeaderTellsHowSureItIs) {
  const auto messages = exported(drive());
  for (int i = 2; i < kFrames; ++i) {
    const DetectedItemHeader& header = messages[i].moving_object(0).header();
    EXPECT_EQ(header.tracking_id().value(), 7U);
    EXPECT_EQ(header.ground_truth_id_size(), 0);
    EXPECT_EQ(header.existence_probability(), 0.875);
    EXPECT_EQ(header.age(), 0.1 * i);
    EXPECT_EQ(header.measurement_state(), i == 5 ? DetectedItemHeader::MEASUREMENT_STATE_PREDICTED
                                                 : DetectedItemHeader::MEASUREMENT_STATE_MEASURED);
    EXPECT_EQ(messages[i].moving_object(0).movement_state(),
              i == 5 ? DetectedMovingObject::MOVEMENT_STATE_UNKNOWN : DetectedMovingObject::MOVEMENT_STATE_MOVING);
  }
}

TEST_F(OsiTraceFile, CandidatesAddUpToOne) {
  using VehicleType = MovingObject::VehicleClassification;
  const std::map<ObjectKind, std::vector<std::pair<MovingObject::Type, VehicleType::Type>>> expected = {
      {ObjectKind::kUnknown, {}},
      {ObjectKind::kCar, {{MovingObject::TYPE_VEHICLE, VehicleType::TYPE_CAR}}},
      {ObjectKind::kLargeVehicle, {{MovingObject::TYPE_VEHICLE, VehicleType::TYPE_HEAVY_TRUCK}}},
      {ObjectKind::kTwoWheeler,
       {{MovingObject::TYPE_VEHICLE, VehicleType::TYPE_MOTORBIKE},
        {MovingObject::TYPE_VEHICLE, VehicleType::TYPE_BICYCLE}}},
      {ObjectKind::kPedestrian, {{MovingObject::TYPE_PEDESTRIAN, VehicleType::TYPE_UNKNOWN}}}};
  for (const auto& [kind, types] : expected) {
    const DetectedMovingObject object = carOf([known = kind](ObjectEstimate& it) { it.cuboid->kind = known; });
    double sum = 0, told = 0;
    ASSERT_EQ(object.candidate_size(), static_cast<int>(types.size()) + 1);
    for (int i = 0; i < object.candidate_size(); ++i) {
      const auto& candidate = object.candidate(i);
      sum += candidate.probability();
      const bool last = i + 1 == object.candidate_size();
      EXPECT_EQ(candidate.type(), last ? MovingObject::TYPE_UNKNOWN : types[i].first);
      EXPECT_EQ(candidate.has_vehicle_classification(), candidate.type() == MovingObject::TYPE_VEHICLE);
      EXPECT_EQ(candidate.vehicle_classification().type(), last ? VehicleType::TYPE_UNKNOWN : types[i].second);
      EXPECT_EQ(candidate.has_upper_body_pose(), candidate.type() == MovingObject::TYPE_PEDESTRIAN);
      if (!last) told += candidate.probability();
    }
    EXPECT_DOUBLE_EQ(sum, 1);
    EXPECT_DOUBLE_EQ(told, types.empty() ? 0 : 0.75);
  }
}

TEST_F(OsiTraceFile, ABodyWithoutCuboidIsAPointOfUnknownKind) {
  const DetectedMovingObject object = carOf([](ObjectEstimate& it) { it.cuboid.reset(); });
  expectVector(object.base().position(), {12 - 0.4 * 4, -3, -1.5});
  EXPECT_FALSE(object.base().has_dimension());
  ASSERT_EQ(object.candidate_size(), 1);
  EXPECT_EQ(object.candidate(0).probability(), 1);
}

TEST_F(OsiTraceFile, TheSensorStandsForAVehicleWithoutAMounting) {
  const auto messages = exported(drive());
  for (int i = 0; i < kFrames; ++i) {
    expectVector(messages[i].host_vehicle_location().position(), {1.0 * i, 0, 0});
    expectAngles(messages[i].host_vehicle_location().orientation(), {0, 0, 0});
    if (i != 9) expectVector(messages[i].host_vehicle_location().velocity(), {10, 0, 0});
    // The camera's axes are right, down, ahead: the vehicle's errors ahead are the third, to the left the first.
    const double rho = std::sqrt(1e-4 * i), phi = std::sqrt(1e-6 * i);
    expectVector(messages[i].host_vehicle_location_rmse().position(), {3 * rho, rho, 2 * rho});
    expectAngles(messages[i].host_vehicle_location_rmse().orientation(), {3 * phi, phi, 2 * phi});
  }
}

TEST_F(OsiTraceFile, AMountingMovesTheVehicleAndNotTheObjects) {
  const SE3 T_vehicle_sensor(expSO3({0, 0, 0.5}), {1.5, 0.25, 1.25});
  const auto messages = exported(drive(), T_vehicle_sensor);
  for (int i = 0; i < kFrames; ++i) {
    const SensorData& message = messages[i];
    expectVector(message.mounting_position().position(), {1.5, 0.25, 1.25});
    expectAngles(message.mounting_position().orientation(), {0, 0, 0.5});
    // The camera looks to the left and yet drives where it looks, so the vehicle drives to its left.
    expectVector(message.host_vehicle_location().position(), {i * std::cos(0.5), i * std::sin(0.5), 0});
    expectAngles(message.host_vehicle_location().orientation(), {0, 0, 0});
    if (i >= 2) expectVector(message.moving_object(0).base().position(), {13 - 0.4 * i, -2.5, -0.75});
  }
  // A turn of the camera moves the rear axle: by 1.25 m times pitch, and by 1.5 and 0.25 m times yaw.
  EXPECT_GT(messages[4].host_vehicle_location_rmse().position().z(),
            exported(drive())[4].host_vehicle_location_rmse().position().z());
}

TEST_F(OsiTraceFile, TellsTheTracesRulesAndDescribesItsMessagesAlone) {
  exported(drive());
  const std::string bytes = folder_.read("trace.mcap");
  EXPECT_TRUE(bytes.ends_with(test::kMcapMagic)) << "an indexed file";
  const auto content = test::readMcap(bytes);
  ASSERT_EQ(content.metadata.size(), 1U);
  const auto& facts = content.metadata.at("net.asam.osi.trace");
  EXPECT_EQ(facts.at("version"), "3.8.0");
  EXPECT_EQ(facts.at("min_osi_version"), "3.7.0");
  EXPECT_EQ(facts.at("max_osi_version"), "3.7.0");
  const int minor = GOOGLE_PROTOBUF_VERSION / 1000 % 1000, patch = GOOGLE_PROTOBUF_VERSION % 1000;
  const std::string protobuf = "3." + std::to_string(minor) + '.' + std::to_string(patch);
  EXPECT_EQ(facts.at("min_protobuf_version"), protobuf);
  EXPECT_EQ(facts.at("max_protobuf_version"), protobuf);
  EXPECT_THAT(facts.at("description"), testing::StartsWith("drive: "));
  ASSERT_EQ(content.schema_of.size(), 1U);
  const auto& [topic, schema] = *content.schema_of.begin();
  EXPECT_THAT(topic, testing::HasSubstr("SensorData"));
  EXPECT_EQ(content.channel_metadata.at(topic).at("net.asam.osi.trace.channel.osi_version"), "3.7.0");
  EXPECT_EQ(content.channel_metadata.at(topic).at("net.asam.osi.trace.channel.protobuf_version"), protobuf);
  google::protobuf::FileDescriptorSet files;
  ASSERT_TRUE(files.ParseFromString(content.schemas.at(schema).descriptors));
  google::protobuf::DescriptorPool pool;  // of its own: nothing that the program knows helps
  for (const auto& file : files.file()) ASSERT_NE(pool.BuildFile(file), nullptr) << file.name();
  EXPECT_NE(pool.FindMessageTypeByName("osi3.SensorData"), nullptr);
}

TEST_F(OsiTraceFile, ARunThatWasKilledHasItsOnlineEstimates) {
  RunFolder run = drive();
  std::swap(run.online, run.final);
  run.final.camera = {run.online.camera[0]};
  const auto messages = exported(run);
  ASSERT_EQ(messages.size(), std::size_t{kFrames});
  EXPECT_TRUE(messages[4].moving_object(0).base_rmse().has_position());
  EXPECT_TRUE(messages[4].has_host_vehicle_location_rmse());
}

TEST_F(OsiTraceFile, TellsWhichFileCannotBeWritten) {
  EXPECT_THAT(test::messageOf<OutputError>([&] { exportOsi(drive(), folder_ / "not there" / "trace.mcap", {}); }),
              testing::HasSubstr("not there/trace.mcap"));
}

}  // namespace
}  // namespace motorcade
