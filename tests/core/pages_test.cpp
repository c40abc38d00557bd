#include "core/pages.hpp"

#include <vector>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

namespace motorcade {
namespace {

/// Fresh memory of some pages, none of them resident.
class FreshPages {
 public:
  explicit FreshPages(std::size_t count)
      : count_(count), begin_(mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {}
  FreshPages(const FreshPages&) = delete;
  FreshPages& operator=(const FreshPages&) = delete;
  ~FreshPages() { munmap(begin_, bytes()); }

  static std::size_t size() { return static_cast<std::size_t>(sysconf(_SC_PAGESIZE)); }
  std::byte* begin() const { return static_cast<std::byte*>(begin_); }
  std::vector<bool> resident() const {
    std::vector<unsigned char> pages(count_);
    EXPECT_EQ(mincore(begin_, bytes(), pages.data()), 0);
    std::vector<bool> resident;
    for (const unsigned char page : pages) resident.push_back((page & 1) != 0);
    return resident;
  }

 private:
  std::size_t bytes() const { return count_ * size(); }

  std::size_t count_;
  void* begin_;
};

TEST(PopulatePages, MakesTheWholePagesWithinResident) {
  const FreshPages probe(1);
  populatePages(probe.begin(), FreshPages::size());
  if (!probe.resident().front()) GTEST_SKIP() << "the system cannot populate pages";
  const FreshPages pages(4);
  populatePages(pages.begin() + 1, 3 * FreshPages::size());
  EXPECT_EQ(pages.resident(), (std::vector<bool>{false, true, true, false}));
}

TEST(PopulatePages, LessThanAPageIsLeftAlone) {
  const FreshPages pages(2);
  populatePages(pages.begin() + 1, FreshPages::size());
  EXPECT_EQ(pages.resident(), (std::vector<bool>{false, false}));
}

}  // namespace
}  // namespace motorcade
