#include "io/rig/yaml_file.hpp"

#include <chrono>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class YamlFile : public testing::Test {
 protected:
  YamlPart read(std::string_view content) { return YamlPart::ofFile(folder_.write("file.yaml", content)); }
  std::string errorOf(std::string_view content) {
    return messageOf<InputError>([&] { read(content); });
  }
  std::vector<double> numbersOf(std::string_view value) {
    return read("a: " + std::string(value) + "\n").at({"a"}).numbers();
  }
  bool hasNoNumbers(std::string_view value) {
    return messageOf<InputError>([&] { numbersOf(value); }).find("line 1: key a holds no list") != std::string::npos;
  }
  test::TemporaryFolder folder_;
};

TEST_F(YamlFile, NumbersAreWhatAStreamReads) {
  EXPECT_THAT(numbersOf("[1, -2.5, +3e1, .5, 5., '7']"), ElementsAre(1, -2.5, 30, 0.5, 5, 7));
  EXPECT_THAT(numbersOf("[[1, 2], [3, [4]]]"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(numbersOf("{rows: 1, data: [8, 9]}"), ElementsAre(8, 9));
  EXPECT_THAT(numbersOf("6"), ElementsAre(6));
  for (const char* value : {"fast", "'1 2'", "0x1p3", "1,2", ".inf", ".nan", "1e400", "1e51", "~", "{b: 1}", "''"})
    EXPECT_TRUE(hasNoNumbers(value)) << value;
}

TEST_F(YamlFile, ListsAreBoundedInLengthAndDepth) {
  std::string list = "[1";
  for (int i = 1; i < 256; ++i) list += ", 1";
  EXPECT_EQ(numbersOf(list + "]").size(), 256U);
  EXPECT_TRUE(hasNoNumbers(list + ", 1]"));
  EXPECT_THAT(numbersOf("[[[[1]]]]"), ElementsAre(1));
  EXPECT_TRUE(hasNoNumbers("[[[[[1]]]]]"));
}

TEST_F(YamlFile, TheFirstOfTwoEqualKeysCountsAndKeysThatAreNoWordsAreNobodys) {
  const YamlPart root = read("a: 1\n[b]: 2\n~: 3\n? {c: d}\n: 4\na: 5\ne:\n");
  EXPECT_THAT(root.at({"b", "a"}).numbers(), ElementsAre(1));
  for (const char* key : {"b", "c", "", "~", "f"}) EXPECT_FALSE(root.find({key})) << key;
  EXPECT_TRUE(root.find({"e"}));  // there, with nothing in it
  EXPECT_FALSE(root.at({"a"}).find({"a"}));
  EXPECT_THAT(messageOf<InputError>([&] { root.at({"e"}).text(); }), HasSubstr("key e holds no word"));
}

TEST_F(YamlFile, AnAliasStandsForWhatItNamesWithThatLine) {
  const YamlPart root = read("a: &first\n  b: [1, x]\nc: *first\nd: &word e\n*word : 7\n");
  EXPECT_THAT(root.at({"e"}).numbers(), ElementsAre(7));
  EXPECT_THAT(messageOf<InputError>([&] { root.at({"c"}).at({"b"}).numbers(); }),
              HasSubstr("file.yaml, line 2: key c.b holds no list"));
}

TEST_F(YamlFile, TheFirstDocumentCounts) {
  EXPECT_THAT(read("%YAML:1.0\n---\na: 1\n---\na: 2\n").at({"a"}).numbers(), ElementsAre(1));
  for (const char* content : {"", "# nothing\n", "[1, 2]", "word", "---\n"})
    EXPECT_THAT(errorOf(content), HasSubstr("file.yaml: holds no keys")) << content;
}

TEST_F(YamlFile, WhatIsNoYamlIsNamedWithItsLine) {
  EXPECT_THAT(errorOf("a: 1\nb: [1, 2\n"), AllOf(HasSubstr("file.yaml, line "), HasSubstr(": is no YAML: ")));
  EXPECT_THAT(errorOf("a: 1\nb: *nothing\n"), HasSubstr("file.yaml, line 2: is no YAML: "));
}

TEST_F(YamlFile, AliasesOfAliasesAreRefusedAtOnce) {
  std::ostringstream laughs;
  laughs << "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 30; ++i) {
    laughs << 'a' << i << ": &a" << i << " [*a" << i - 1;
    for (int k = 0; k < 8; ++k) laughs << ", *a" << i - 1;
    laughs << "]\n";
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(errorOf(laughs.str()), HasSubstr("is no calibration: it has too many parts"));
  constexpr std::chrono::seconds kMost(2);  // it takes 0.05 s; sanitizers slow it down
  EXPECT_LT(std::chrono::steady_clock::now() - start, kMost);

  std::string long_words = "a: &a '" + std::string(1000000, 'x') + "'\nb: [*a";
  for (int i = 0; i < 100; ++i) long_words += ", *a";
  EXPECT_THAT(errorOf(long_words + "]\n"), HasSubstr("line 2: is no calibration: it has too many parts"));
}

TEST_F(YamlFile, WhatNestsTooDeepOrHoldsItselfIsRefused) {
  EXPECT_TRUE(read("a: " + std::string(63, '[') + std::string(63, ']') + "\n").find({"a"}));
  EXPECT_THAT(errorOf("a: " + std::string(64, '[') + std::string(64, ']') + "\n"),
              HasSubstr("line 1: is no calibration: it nests too deep"));
  EXPECT_THAT(errorOf("a: " + std::string(100000, '[')), HasSubstr("is no calibration: it nests too deep"));
  EXPECT_THAT(errorOf("a: &a\n  b: *a\n"), HasSubstr("line 2: is no calibration: a part holds itself"));
}

}  // namespace
}  // namespace motorcade
