#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/apps/merge/merged_batch_by_hand.hpp"

/// Probabilities and standard deviations of a batch's rows, against what is so.
namespace motorcade {
namespace {

using test::MergeBatch;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(MergeBatch, ExistenceIsCountedOverAllDrives) {
  write("a", {{.drive = "x", .ate_m = 0.25}, {.drive = "y", .ate_m = 0.5}, {.drive = "z", .labels = false}});
  const auto json = nlohmann::json::parse(merged("results.json"));
  const double brier = (90 * 0.2 * 0.2 + 30 * 0.8 * 0.8) / 120;
  EXPECT_NEAR(json["tasks"][0]["measures"]["existence_brier"], brier, 1e-12);
  EXPECT_TRUE(json["tasks"][2]["measures"]["existence_brier"].is_null());
  const auto& final = json["existence"]["default"]["final"];
  EXPECT_EQ(final["rows"], 240);
  EXPECT_EQ(final["tenths"][8]["real"], 180);
  EXPECT_NEAR(final["brier"], brier, 1e-12);
  EXPECT_NEAR(final["largest_gap"], 0.05, 1e-12);
  EXPECT_THAT(merged("results.md"), AllOf(HasSubstr("| set | estimate | rows | Brier | largest gap | 0.8 to 0.9 |\n"),
                                          HasSubstr("| default | final | 240 | 0.19 | 0.05 | 0.75 of 0.8 (240) |\n"),
                                          HasSubstr("| default | online | 160 | 0.04 | 0.2 | 1 of 0.8 (160) |\n")));
  EXPECT_THAT(merged("report.html"), HasSubstr("<td class=\"number\">0.75 of 0.8 (240)</td>"));
}

TEST_F(MergeBatch, KindsAreCountedOverAllDrives) {
  write("a", {{.drive = "x", .ate_m = 0.25}, {.drive = "y", .ate_m = 0.5}, {.drive = "z", .labels = false}});
  const auto json = nlohmann::json::parse(merged("results.json"));
  EXPECT_EQ(json["tasks"][0]["measures"]["kinds_log_loss"], 0.625);
  EXPECT_EQ(json["tasks"][0]["measures"]["kinds_sure_wrong"], 0.125);
  EXPECT_TRUE(json["tasks"][0]["measures"]["online_kinds_log_loss"].is_null());
  EXPECT_TRUE(json["tasks"][2]["measures"]["kinds_log_loss"].is_null());
  const auto& final = json["kinds"]["default"]["final"];
  EXPECT_EQ(final["rows"], 100);
  EXPECT_EQ(final["tenths"][8]["right"], 90);
  EXPECT_NEAR(final["largest_gap"], 0.1, 1e-12);
  EXPECT_EQ(json["kinds"]["default"]["online"]["rows"], 0);
  EXPECT_THAT(merged("results.md"), AllOf(HasSubstr("| 0.625 / - | 12.5 % / - |"),
                                          HasSubstr("| default | final | 100 | 0.1 | 0.1 | 0.9 of 0.8 (100) |\n")));
  EXPECT_THAT(merged("report.html"), HasSubstr("<td class=\"number\">0.9 of 0.8 (100)</td>"));
}

/// The camera's own covariance counts where the truth's noise is not known.
TEST_F(MergeBatch, CovariancesAreComparedWithErrorsByAxis) {
  write("a", {{.drive = "x"}, {.drive = "y"}});
  const std::string shares = " 80 / 80 / 80 % | 80 / 80 / 80 % | 80 / 80 / 80 % |";
  const std::string table = merged("results.md");
  EXPECT_THAT(table, HasSubstr("| default | final | camera, over ten frames | 20 |" + shares + shares + "\n"));
  EXPECT_THAT(table, HasSubstr("| default | final | camera, since the start | 20 |" + shares));
  EXPECT_THAT(table, HasSubstr("| default | online | camera, over ten frames | 20 |" + shares));
  EXPECT_THAT(table, Not(HasSubstr("| default | online | objects |"))) << "there are none";
  const auto json = nlohmann::json::parse(merged("results.json"));
  EXPECT_EQ(json["covariances"]["default"]["final"]["camera, since the start"]["about_z"][9], 4);
  const std::string page = merged("report.html");
  EXPECT_THAT(page, HasSubstr("default, final: camera, since the start (20 errors)"));
  EXPECT_THAT(page, HasSubstr("found, %"));
}

TEST_F(MergeBatch, SharesOfSizesWithinTwoStandardDeviationsAreAColumn) {
  write("a", {{.drive = "x", .ate_m = 0.25}});
  const auto json = nlohmann::json::parse(merged("results.json"));
  EXPECT_EQ(json["tasks"][0]["measures"]["box_length_in_2_sigma"], 0.75);
  EXPECT_THAT(merged("results.md"), HasSubstr("| 75 % / 50 % / 100 % |"));
}

}  // namespace
}  // namespace motorcade
