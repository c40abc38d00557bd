#include "io/files/file_names.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(NaturalOrder, CountsAsPeopleDo) {
  std::vector<std::string> names{"10.png", "9.png", "a10b2", "a10b10", "a9b1", "010.png", "1.png", "", "a"};
  std::ranges::sort(names, naturallyBefore);
  EXPECT_THAT(names, ElementsAre("", "1.png", "9.png", "010.png", "10.png", "a", "a9b1", "a10b2", "a10b10"));
}

TEST(NaturalOrder, OrdersNumbersOfAnyLength) {
  const std::string many(40, '9');
  EXPECT_TRUE(naturallyBefore("1403636579763555584", many));
  EXPECT_TRUE(naturallyBefore(many, "1" + many));
  EXPECT_FALSE(naturallyBefore("0" + many, many.substr(1)));
}

TEST(NaturalOrder, OfPaddedNamesIsThatOfPlainText) {
  EXPECT_TRUE(naturallyBefore("000009.png", "000010.png"));
  EXPECT_FALSE(naturallyBefore("000010.png", "000010.png"));
}

TEST(NaturalOrder, FoldersAreListedInIt) {
  const test::TemporaryFolder folder;
  for (const char* name : {"img10.png", "img2.png", "img1.png"}) folder.write(name, "");
  EXPECT_THAT(listFolder(folder.path()), ElementsAre(folder / "img1.png", folder / "img2.png", folder / "img10.png"));
  EXPECT_THAT(listFolderIfThere(folder / "nowhere"), IsEmpty());
}

TEST(ShellWord, IsTakenBackByAShell) {
  EXPECT_EQ(shellWord("/data/run_1"), "/data/run_1");
  for (const std::string word : {"/data/my drive", "it's", "a$b`c`\"d\"", "", "a*b", "~x", "-"}) {
    const std::string command = "printf %s " + shellWord(word);
    FILE* const shell = ::popen(command.c_str(), "r");
    std::string back;
    for (int letter = std::fgetc(shell); letter != EOF; letter = std::fgetc(shell)) back += static_cast<char>(letter);
    EXPECT_EQ(::pclose(shell), 0);
    EXPECT_EQ(back, word);
  }
}

}  // namespace
}  // namespace motorcade
