#include "apps/export/export_command.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

std::string refusalOf(const ExportOptions& options) {
  return test::messageOf<UsageError>([&] { runExport(options); });
}

TEST(ExportCommand, TellsWhatToWrite) {
  EXPECT_THAT(refusalOf({.run = "run"}), testing::HasSubstr("--mcap FILE, --osi FILE, --tum DIR"));
}

TEST(ExportCommand, AMountingIsForOsiAlone) {
  EXPECT_THAT(refusalOf({.run = "run", .mounting = "1,0,1,0,0,0", .tum = "tum"}), testing::HasSubstr("--osi FILE"));
  EXPECT_THAT(refusalOf({.run = "run", .osi = "trace.mcap", .mounting = "1,0,1"}),
              testing::HasSubstr("write X,Y,Z,ROLL,PITCH,YAW"));
}

}  // namespace
}  // namespace motorcade
