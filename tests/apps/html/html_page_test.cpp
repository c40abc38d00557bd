#include "apps/html/html_page.hpp"

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>

namespace motorcade {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(HtmlPage, TextThatLooksLikeMarkupStaysText) {
  EXPECT_EQ(escaped("<b onload=\"x('1')\"> & more"), "&lt;b onload=&quot;x(&#39;1&#39;)&quot;&gt; &amp; more");
  EXPECT_EQ(escaped("10 m\n\tM\xC3\xBCnchen"), "10 m\n\tM\xC3\xBCnchen");
  EXPECT_EQ(escaped(std::string_view("1\000x\x1B", 4)), "1\xEF\xBF\xBDx\xEF\xBF\xBD");
}

/// The examples of RFC 4648, section 10.
TEST(HtmlPage, Base64IsThatOfTheStandard) {
  for (const auto& [bytes, text] :
       {std::pair("", ""), std::pair("f", "Zg=="), std::pair("fo", "Zm8="), std::pair("foo", "Zm9v"),
        std::pair("foob", "Zm9vYg=="), std::pair("fooba", "Zm9vYmE="), std::pair("foobar", "Zm9vYmFy")})
    EXPECT_EQ(base64(std::string_view(bytes)), text);
  const std::array high{std::byte{0xFF}, std::byte{0xFB}, std::byte{0xF0}, std::byte{0x00}};
  EXPECT_EQ(base64(high), "//vwAA==");
}

TEST(HtmlPage, AnImageStandsInThePageItself) { EXPECT_EQ(dataUri("image/png", "foo"), "data:image/png;base64,Zm9v"); }

TEST(HtmlPage, APageIsWholeAndAsksForNothingFromElsewhere) {
  const std::string page = htmlPage("a < b", "<p>body</p>", ".mine { color: red; }");
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_THAT(page, AllOf(HasSubstr("<title>a &lt; b</title>"), HasSubstr("<p>body</p>"), HasSubstr(".mine { color"),
                          HasSubstr("charset=\"utf-8\""), HasSubstr("width=device-width")));
  EXPECT_THAT(page, AllOf(HasSubstr("prefers-color-scheme: dark"), HasSubstr("@media print")));
  for (const char* elsewhere : {"http:", "https:", "@import", "url(", "<link", "<script"})
    EXPECT_THAT(page, Not(HasSubstr(elsewhere)));
}

TEST(HtmlPage, EachColorIsThereInLightInDarkAndOnPaper) {
  const std::string page = htmlPage("", "");
  for (const char* color : {"--page:", "--ink:", "--muted:", "--rule:", "--card:", "--accent:", "--good:", "--warn:"}) {
    int count = 0;
    for (auto at = page.find(color); at != std::string::npos; at = page.find(color, at + 1)) ++count;
    EXPECT_EQ(count, 3) << color;
  }
}

}  // namespace
}  // namespace motorcade
