#include "io/messages/image_topics.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(ImageTopics, TheCameraInfoLiesBesideTheImages) {
  EXPECT_EQ(cameraInfoTopicOf("/stereo/left/image_raw"), "/stereo/left/camera_info");
  EXPECT_EQ(cameraInfoTopicOf("/stereo/left/image_raw/compressed"), "/stereo/left/camera_info");
  EXPECT_EQ(cameraInfoTopicOf("left"), "camera_info");
  EXPECT_EQ(cameraInfoTopicOf("/left"), "/camera_info");
}

TEST(ImageTopics, TheNameTellsWhetherImagesAreRectified) {
  EXPECT_TRUE(isRectifiedTopic("/left/image_rect"));
  EXPECT_TRUE(isRectifiedTopic("/left/image_rect_color/compressed"));
  EXPECT_TRUE(isRectifiedTopic("image_rect"));
  EXPECT_FALSE(isRectifiedTopic("/left/image_raw"));
  EXPECT_FALSE(isRectifiedTopic("/image_rect/image_raw"));
}

}  // namespace
}  // namespace motorcade
