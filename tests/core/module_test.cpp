#include "core/module.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <latch>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

constexpr char kFunction[] = "motorcade_for_test";
using Function = int(int);

/// Folder of this program's modules.
fs::path modulesFolder() { return fs::read_symlink("/proc/self/exe").parent_path() / "motorcade"; }

int three() { return 3; }

TEST(Module, IsLoadedFromTheFolderBesideTheProgram) {
  auto* const function = linkedOrLoaded<Function>(nullptr, "for_test", kFunction);
  EXPECT_EQ(function(41), 42);
  EXPECT_EQ(fileOfAddress(reinterpret_cast<const void*>(function)), modulesFolder() / "for_test.so");
}

TEST(Module, IsNotAskedForWhatIsLinkedIn) { EXPECT_EQ(linkedOrLoaded(&three, "absent", "three")(), 3); }

TEST(Module, IsTheSameForAllThreadsThatAskAtOnce) {
  constexpr int kThreads = 8;
  std::array<void*, kThreads> functions{};
  std::latch start(kThreads);
  {
    std::vector<std::jthread> threads;
    for (void*& function : functions)
      threads.emplace_back([&] {
        start.arrive_and_wait();
        function = moduleFunction("for_test", kFunction);
      });
  }
  EXPECT_NE(functions[0], nullptr);
  EXPECT_THAT(functions, testing::Each(functions[0]));
}

TEST(Module, SaysWhichFileIsMissingAndWhatToDo) {
  EXPECT_THAT(
      messageOf<ModuleError>([] { moduleFunction("absent", kFunction); }),
      AllOf(HasSubstr((modulesFolder() / "absent.so").string() + " is not there"),
            HasSubstr("install the package libmotorcade"), HasSubstr("build the target motorcade_absent_module")));
}

TEST(Module, IsNeverLookedForInTheWorkingFolder) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "motorcade");
  fs::copy_file(modulesFolder() / "for_test.so", folder / "motorcade/elsewhere.so");
  fs::copy_file(modulesFolder() / "for_test.so", folder / "elsewhere.so");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  EXPECT_THAT(messageOf<ModuleError>([] { moduleFunction("elsewhere", kFunction); }),
              HasSubstr((modulesFolder() / "elsewhere.so").string() + " is not there"));
  fs::current_path(before);
}

TEST(Module, OfAnotherVersionIsRefused) {
  EXPECT_THAT(
      messageOf<ModuleError>([] { moduleFunction("for_test", "motorcade_for_test_2"); }),
      AllOf(HasSubstr("for_test.so is of another version, without motorcade_for_test_2"), HasSubstr("install")));
}

TEST(Module, ThatIsDamagedIsRefused) {
  const fs::path file = modulesFolder() / "damaged.so";
  std::ofstream(file) << "no code";
  EXPECT_THAT(messageOf<ModuleError>([] { moduleFunction("damaged", kFunction); }),
              AllOf(HasSubstr("damaged.so cannot be loaded ("), HasSubstr("install")));
  fs::remove(file);
}

}  // namespace
}  // namespace motorcade
