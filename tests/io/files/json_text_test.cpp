#include "io/files/json_text.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace motorcade {
namespace {

TEST(JsonText, KeepsTheOrderOfItsKeys) {
  const std::string text = R"({"z":1,"a":[true,null]})";
  EXPECT_EQ(jsonText(parsedOrderedJson(text)), text);
  EXPECT_EQ(jsonText(parsedOrderedJson(text), 1), "{\n \"z\": 1,\n \"a\": [\n  true,\n  null\n ]\n}");
}

TEST(JsonText, ReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(jsonText(nlohmann::ordered_json("drive \xff")), "\"drive \xEF\xBF\xBD\"");
}

TEST(JsonText, TellsWhatIsNoJson) {
  EXPECT_THROW(parsedJson("{\"a\":"), nlohmann::json::exception);
  EXPECT_THROW(parsedOrderedJson("{\"a\":"), nlohmann::json::exception);
  EXPECT_TRUE(jsonOrDiscarded("{\"a\":").is_discarded());
  EXPECT_EQ(jsonOrDiscarded("{\"a\":2}").at("a"), 2);
}

}  // namespace
}  // namespace motorcade
