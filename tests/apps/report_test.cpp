#include <map>

#include <gmock/gmock.h>

#include "io/run_folder.hpp"
#include "tests/apps/program_run.hpp"

namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class Report : public Run {
 protected:
  std::string page(const std::string& name) const { return contentOf(out(name) / "report.html"); }
};

TEST_F(Report, IsOneFileThatTellsOfTheWholeRun) {
  ASSERT_EQ(run("drive", "--masks"), 0);
  ASSERT_EQ(motorcade("report " + out("drive").string()), 0);
  const std::string html = page("drive");
  EXPECT_EQ(countOf(html, "src=\""), countOf(html, "src=\"data:image/jpeg;base64,"));
  for (const char* of_others : {"<script", "<link", "http://", "https://", "url("})
    EXPECT_THAT(html, Not(HasSubstr(of_others)));
  std::map<std::int64_t, int> rows;
  for (const auto& row : readRunFolder(out("drive")).final.objects) ++rows[row.object.track.value];
  ASSERT_FALSE(rows.empty());
  std::size_t charts = 0;
  for (const auto& [track, count] : rows) charts += count >= 5;
  EXPECT_EQ(countOf(html, "<figcaption>Object "), charts);
  EXPECT_THAT(html,
              AllOf(HasSubstr("camera ATE"), HasSubstr("<img alt=\"frame "), HasSubstr("[backend]"),
                    HasSubstr("moving objects (final)"), HasSubstr("incremental optimization"), HasSubstr("Release")));
}

TEST_F(Report, ComparesWithABaseline) {
  ASSERT_EQ(run("drive"), 0);
  const std::string baseline = (out("drive") / "camera_online.txt").string();
  ASSERT_EQ(
      motorcade("report " + out("drive").string() + " --out " + out("page.html").string() + " --baseline " + baseline),
      0);
  EXPECT_EQ(countOf(contentOf(out("page.html")), ">baseline</text>"), 2u);  // on the map and over time
  EXPECT_FALSE(fs::exists(out("drive") / "report.html"));
}

TEST_F(Report, OfADriveThatIsGoneTellsWithoutPicturesAndTruth) {
  fs::copy(kSequence, out("moved"), fs::copy_options::recursive);
  ASSERT_EQ(run("drive", "", out("moved")), 0);
  fs::remove_all(out("moved"));
  ASSERT_EQ(motorcade("report " + out("drive").string()), 0);
  const std::string html = page("drive");
  EXPECT_THAT(html, AllOf(HasSubstr("Without pictures and truth"), Not(HasSubstr("<img")), HasSubstr("The drive"),
                          Not(HasSubstr("camera ATE"))));
  EXPECT_EQ(motorcade("report " + out("drive").string() + " --sequence " + out("moved").string()), 3);
}

TEST_F(Report, OfNoRunIsRefused) {
  EXPECT_EQ(motorcade("report " + out("nothing").string()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("no run folder"));
}

}  // namespace
}  // namespace motorcade::test
