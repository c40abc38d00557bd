#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/results/run_folder.hpp"
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

/// The path of each line of the report's map that is drawn in one color.
std::vector<std::string> linesOf(const std::string& map, const std::string& color) {
  std::vector<std::string> lines;
  const std::string key = "style=\"stroke:" + color + "\" d=\"";
  for (auto at = map.find(key); at != std::string::npos; at = map.find(key, at + 1)) {
    const auto begin = at + key.size();
    lines.push_back(map.substr(begin, map.find('"', begin) - begin));
  }
  return lines;
}

TEST_F(Report, TheTruthIsBrokenWhereACarWasOutOfView) {
  fs::copy(kSequence, out("gap"), fs::copy_options::recursive);
  std::istringstream labels(contentOf(out("gap") / "label_02.txt"));
  std::ofstream fewer(out("gap") / "label_02.txt");
  std::size_t left_out = 0;
  for (std::string line; std::getline(labels, line);) {
    const int frame = std::stoi(line);
    if (frame == 6 || frame == 7)
      ++left_out;
    else
      fewer << line << '\n';
  }
  fewer.close();
  ASSERT_GT(left_out, 0u);
  ASSERT_EQ(run("whole"), 0);
  ASSERT_EQ(run("gap_run", "", out("gap")), 0);
  const auto breaks = [&](const std::string& name) {
    EXPECT_EQ(motorcade("report " + out(name).string()), 0);
    const std::string html = page(name), map = html.substr(0, html.find("</svg>"));
    std::size_t pieces = 0, lines = 0;
    for (const std::string& line : linesOf(map, "var(--truth)")) {
      ++lines;
      pieces += countOf(line, "M");
    }
    EXPECT_GT(lines, 1u) << "the camera's and a car's";
    return pieces - lines;
  };
  EXPECT_EQ(breaks("whole"), 0u);
  EXPECT_GT(breaks("gap_run"), 0u);
}

TEST_F(Report, TellsALatencyOnlyWherePairsWereDueAtAPace) {
  ASSERT_EQ(run("fast"), 0);
  ASSERT_EQ(motorcade("report " + out("fast").string()), 0);
  EXPECT_THAT(page("fast"), AllOf(HasSubstr("processing of a pair, without waiting, 99 of 100 frames"),
                                  HasSubstr(">processing, ms</text>"), Not(HasSubstr("latency, 99 of 100 frames"))));
  ASSERT_EQ(run("paced", "--rate 20"), 0);
  ASSERT_EQ(motorcade("report " + out("paced").string()), 0);
  EXPECT_THAT(page("paced"), AllOf(HasSubstr("latency, 99 of 100 frames"), HasSubstr(">latency, ms</text>"),
                                   Not(HasSubstr("without waiting"))));
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
